"""What every answer carries, and who gets one: headers, and the token where one is asked for."""

from collections.abc import Callable
from http import HTTPStatus

from django.conf import settings
from django.core.exceptions import MiddlewareNotUsed
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render
from django.utils.crypto import constant_time_compare, salted_hmac
from django.utils.http import url_has_allowed_host_and_scheme

Handler = Callable[[HttpRequest], HttpResponse]


def security_headers(get_response: Handler) -> Handler:
    """Add the headers that Django leaves to others, and words to its empty 405.

    Pages are never kept by a browser: the back button shows what is the case now.
    """

    def handle(request: HttpRequest) -> HttpResponse:
        response = get_response(request)
        if response.status_code == HTTPStatus.METHOD_NOT_ALLOWED and not response.content:
            allowed = response['Allow']
            response = render(request, '405.html', status=HTTPStatus.METHOD_NOT_ALLOWED)
            response['Allow'] = allowed
        response['Content-Security-Policy'] = settings.CONTENT_SECURITY_POLICY
        response['Cross-Origin-Resource-Policy'] = 'same-origin'
        response.setdefault('Cache-Control', 'no-store')
        return response

    return handle


def access(get_response: Handler) -> Handler:
    """Let nobody in without the token, which an address has once and a cookie from then on.

    The cookie has no token in it, but what only the token makes: it holds across
    restarts with the same token.
    """
    token = settings.ACCESS_TOKEN
    if not token:
        raise MiddlewareNotUsed
    name = f'{settings.SITE.name}_access'
    proof = salted_hmac('mirror_explainer', 'access', token, algorithm='sha256').hexdigest()

    def handle(request: HttpRequest) -> HttpResponse:
        if constant_time_compare(request.GET.get('token', ''), token):
            # So that no history or referrer has the token.
            others = request.GET.copy()
            del others['token']
            # Nor does it lead elsewhere: a path such as //example.org would.
            page = request.path if url_has_allowed_host_and_scheme(request.path, None) else '/'
            response = HttpResponseRedirect(f'{page}?{others.urlencode()}' if others else page)
            response.set_cookie(name, proof, httponly=True, samesite='Lax')
            return response
        known = constant_time_compare(request.COOKIES.get(name, ''), proof)
        if known:
            return get_response(request)
        return render(request, 'no_access.html', status=HTTPStatus.FORBIDDEN)

    return handle
