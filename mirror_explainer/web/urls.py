"""The routes of whatever site this process serves."""

from django.conf import settings
from django.urls import include, path

from mirror_explainer.web.static_files import static_routes

urlpatterns = [*static_routes(), path('', include(f'{settings.SITE.app}.urls'))]
