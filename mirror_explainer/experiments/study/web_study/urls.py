"""The routes of the study's pages, and by which method each is asked for."""

from django.urls import path
from django.views.decorators.http import require_GET, require_http_methods, require_POST

from mirror_explainer.experiments.study.web_study import views

urlpatterns = [
    path('', require_GET(views.welcome)),
    path('join', require_POST(views.join)),
    path('resume', require_POST(views.resume)),
    path('study', require_GET(views.study)),
    path('start', require_POST(views.start)),
    path('answer', require_POST(views.give)),
    path('leave', require_http_methods(['GET', 'POST'])(views.leave)),
]
