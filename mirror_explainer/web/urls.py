"""The routes of whatever site this process serves."""

from django.conf import settings
from django.urls import include, path

from mirror_explainer.web.refusals import bad_request

urlpatterns = [path('', include(f'{settings.SITE.app}.urls'))]
handler400 = bad_request
