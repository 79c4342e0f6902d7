"""The routes of the study's pages, and by which method each is asked for."""

from django.urls import path
from django.views.decorators.http import require_http_methods, require_POST, require_safe

from mirror_explainer.experiments.study.web_study import researcher, views

urlpatterns = [
    path('', require_safe(views.welcome)),
    path('join', require_POST(views.join)),
    path('resume', require_POST(views.resume)),
    path('study', require_safe(views.study)),
    path('start', require_POST(views.start)),
    path('answer', require_POST(views.give)),
    path('check', require_POST(views.check)),
    path('close', require_POST(views.close)),
    path('leave', require_http_methods(['GET', 'HEAD', 'POST'])(views.leave)),
    path('researcher', require_safe(researcher.overview)),
    path('researcher/study.zip', require_safe(researcher.download)),
]
