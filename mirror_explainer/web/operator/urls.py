"""The routes of the operator's page."""

from django.urls import path
from django.views.decorators.http import require_POST, require_safe

from mirror_explainer.web.operator import views

urlpatterns = [
    path('', require_safe(views.page), name='page'),
    path('news', require_safe(views.news), name='news'),
    *(
        path(view.__name__, require_POST(view), name=view.__name__)
        for view in (views.ask, views.adjust, views.forget, views.restart)
    ),
]
