"""The routes of whatever site this process serves."""

from django.conf import settings
from django.urls import include, path

from mirror_explainer.web.static_files import static_routes
from mirror_explainer.web.unknown_hosts import bad_request

urlpatterns = [*static_routes(), path('', include(f'{settings.SITE.app}.urls'))]
handler400 = bad_request
