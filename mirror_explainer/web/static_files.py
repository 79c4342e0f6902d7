"""The static files: a fixed list, read when the server starts.

No part of a request is ever made into a path, and no file is served that was not there then.
"""

import mimetypes
from collections.abc import Callable
from hashlib import sha256
from importlib import import_module
from pathlib import Path

from django.conf import settings
from django.http import HttpRequest, HttpResponse
from django.urls import URLPattern, path
from django.views.decorators.http import condition


def static_routes() -> list[URLPattern]:
    """Return a route for every file of static/, the site's and those of all sites, and htmx."""
    folders = [_folder('mirror_explainer.web'), _folder(settings.SITE.app)]
    files = [file for folder in folders for file in folder.glob('*') if file.is_file()]
    htmx = _folder('django_htmx') / 'django_htmx' / 'htmx-2.min.js'
    prefix = settings.STATIC_URL.lstrip('/')
    return [
        path(f'{prefix}{name}', _view(file), name=name)
        for name, file in [*((file.name, file) for file in files), ('htmx.min.js', htmx)]
    ]


def _folder(package: str) -> Path:
    return Path(str(import_module(package).__file__)).parent / 'static'


def _view(file: Path) -> Callable[[HttpRequest], HttpResponse]:
    content = file.read_bytes()
    tag = f'"{sha256(content).hexdigest()}"'
    kind, _ = mimetypes.guess_type(file.name)

    def view(request: HttpRequest) -> HttpResponse:
        return HttpResponse(content, content_type=kind, headers={'Cache-Control': 'no-cache'})

    conditional: Callable[[HttpRequest], HttpResponse] = condition(lambda request: tag)(view)
    return conditional
