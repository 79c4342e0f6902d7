"""A site, where it is served, and the Django settings that follow from both.

Settings are made in code, so that a page is a package like any other. Django keeps
them for the whole process: one process serves one site.
"""

import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import django
from django.conf import settings

from mirror_explainer.web.address import Address
from mirror_explainer.web.refusals import log_few_lines

# Nothing from elsewhere, nothing inline: a page can neither load nor run what we did not write.
_POLICY = {
    'default-src': "'none'",
    'script-src': "'self'",
    'style-src': "'self'",
    'img-src': "'self'",
    'connect-src': "'self'",
    'form-action': "'self'",
    'base-uri': "'none'",
    'frame-ancestors': "'none'",
}
CONTENT_SECURITY_POLICY = '; '.join(f'{what} {where}' for what, where in _POLICY.items())


@dataclass(frozen=True)
class Site:
    """Some pages that are served together.

    `app` is the package of a Django app: its templates/ and static/ are used, its
    module `urls` has the urlpatterns. `name`, one word, begins the names of its
    cookies, for a browser does not tell the ports of one machine apart. `database`
    is an SQLite file, None for pages that keep nothing.
    """

    name: str
    app: str
    database: Path | None = None


def configure(site: Site, address: Address | None = None) -> None:
    """Set Django up for this site, once a process; its database is brought up to date.

    Without an address nothing can be served, only the database be used.
    """
    names = address.names if address else ()
    settings.configure(
        SITE=site,
        ACCESS_TOKEN=address.token if address else None,
        ALLOWED_HOSTS=list(names),
        # So that forms can be sent through a proxy with TLS, which passes them on without.
        CSRF_TRUSTED_ORIGINS=[f'https://{name}' for name in names],
        CONTENT_SECURITY_POLICY=CONTENT_SECURITY_POLICY,
        # Signs nothing that has to outlive the process.
        SECRET_KEY=secrets.token_urlsafe(32),
        ROOT_URLCONF='mirror_explainer.web.urls',
        INSTALLED_APPS=[
            'django.contrib.staticfiles',
            'django_htmx',
            'mirror_explainer.web',
            site.app,
        ],
        MIDDLEWARE=[
            'mirror_explainer.web.middleware.security_headers',
            'django.middleware.security.SecurityMiddleware',
            'django.middleware.clickjacking.XFrameOptionsMiddleware',
            'django.middleware.common.CommonMiddleware',  # checks the Host header first
            # A list of the files in static/ of all apps, made at the start: no path of a
            # request is ever looked up.
            'whitenoise.middleware.WhiteNoiseMiddleware',
            'mirror_explainer.web.middleware.access',
            'django.middleware.csrf.CsrfViewMiddleware',
        ],
        TEMPLATES=[
            {
                'BACKEND': 'django.template.backends.django.DjangoTemplates',
                'APP_DIRS': True,
                'OPTIONS': {
                    'builtins': ['django.templatetags.static'],
                    'context_processors': ['django.template.context_processors.request'],
                },
            }
        ],
        DATABASES=_databases(site.database),
        DEFAULT_AUTO_FIELD='django.db.models.BigAutoField',
        STATIC_URL='/static/',
        WHITENOISE_USE_FINDERS=True,
        WHITENOISE_AUTOREFRESH=False,
        WHITENOISE_MAX_AGE=0,
        WHITENOISE_ALLOW_ALL_ORIGINS=False,
        APPEND_SLASH=False,
        USE_I18N=False,
        USE_TZ=True,
        CSRF_COOKIE_NAME=f'{site.name}_csrf',
        CSRF_COOKIE_HTTPONLY=True,
        CSRF_COOKIE_SAMESITE='Lax',
        X_FRAME_OPTIONS='DENY',
        SECURE_REFERRER_POLICY='same-origin',
        LOGGING_CONFIG=None,
    )
    log_few_lines()
    django.setup()
    if site.database is not None:
        from django.core.management import call_command

        call_command('migrate', verbosity=0)


def _databases(file: Path | None) -> dict[str, Any]:
    """Return Django's databases: at most one SQLite file, safe against kills and power cuts."""
    if file is None:
        return {}
    return {
        'default': {
            'ENGINE': 'django.db.backends.sqlite3',
            'NAME': file,
            'CONN_MAX_AGE': None,  # a connection a thread, for as long as it lives
            'OPTIONS': {
                'init_command': 'PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;',
                # Readers that go on to write would otherwise fail when two of them meet.
                'transaction_mode': 'IMMEDIATE',
                'timeout': 20,  # s, to wait for another writer
            },
        }
    }
