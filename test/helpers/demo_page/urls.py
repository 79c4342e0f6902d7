"""A page with a form that says what it was sent."""

from django.http import HttpResponse
from django.template import engines
from django.urls import path
from django.views.decorators.http import require_POST

FORM = """
{% extends 'base.html' %}
{% block title %}Demo{% endblock %}
{% block head %}{% include 'htmx.html' %}{% endblock %}
{% block main %}
<h1>Demo</h1>
<form method="post" hx-post="/" hx-target="#said">
{% csrf_token %}<label>Say <input type="text" name="said"></label> <button>Send</button>
</form>
<p id="said">nothing</p>
{% endblock %}
"""


def demo(request):
    if request.method == 'POST':
        return HttpResponse(request.POST['said'])
    return HttpResponse(engines['django'].from_string(FORM).render({}, request))


def broken(request):
    raise RuntimeError('broken on purpose')


urlpatterns = [path('', demo), path('broken', broken), path('takes_forms', require_POST(demo))]
