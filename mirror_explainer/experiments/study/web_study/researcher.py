"""The researcher's page: who has begun, finished and dropped out, and all tables to download."""

import io
import zipfile
from collections.abc import Callable
from statistics import median

from django.http import Http404, HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render
from django.utils import timezone
from django.utils.crypto import constant_time_compare, salted_hmac

from mirror_explainer.experiments.study.web_study import records
from mirror_explainer.experiments.study.web_study.design import from_json
from mirror_explainer.experiments.study.web_study.models import Study
from mirror_explainer.experiments.study.web_study.study_file import StudyFile

_COOKIE = 'study_researcher'
_View = Callable[[HttpRequest], HttpResponse]


def _for_researchers(view: _View) -> _View:
    """Show a page only to who knows the key: an address has it once, a cookie its proof.

    To others there is no such page.
    """

    def guarded(request: HttpRequest) -> HttpResponse:
        key = Study.objects.get().key
        proof = salted_hmac('mirror_explainer', 'researcher', key, algorithm='sha256').hexdigest()
        if constant_time_compare(request.GET.get('key', ''), key):
            response = HttpResponseRedirect('/researcher')
            response.set_cookie(
                _COOKIE, proof, httponly=True, samesite='Strict', path='/researcher'
            )
            return response
        if not constant_time_compare(request.COOKIES.get(_COOKIE, ''), proof):
            raise Http404
        return view(request)

    return guarded


@_for_researchers
def overview(request: HttpRequest) -> HttpResponse:
    """Say how the study goes."""
    kept = Study.objects.get()
    design, study = from_json(kept.design), StudyFile.model_validate_json(kept.texts)
    finished, others = records.participants(design, study)
    now = timezone.now()
    quiet = [
        last is None or (now - last).total_seconds() > 60 * records.QUIET
        for last in map(records.last_answer, others)
    ]
    times = [minutes for one in finished if (minutes := records.minutes(one)) is not None]
    people = [
        *records.people(finished, True, design, study),
        *records.people(others, False, design, study),
    ]
    context = {
        'begun': len(finished) + len(others),
        'finished': len(finished),
        'dropped': sum(quiet),
        'under_way': len(quiet) - sum(quiet),
        'quiet_minutes': records.QUIET,
        'median_minutes': median(times) if times else None,
        'people': people,
        'study_title': study.text(study.title, study.languages[0]),
    }
    return render(request, 'study/researcher.html', context)


@_for_researchers
def download(request: HttpRequest) -> HttpResponse:
    """Return all tables as CSV files in one archive."""
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.study.web_study.export import tables

    kept = Study.objects.get()
    archive = io.BytesIO()
    found = tables(from_json(kept.design), StudyFile.model_validate_json(kept.texts))
    with zipfile.ZipFile(archive, 'w', zipfile.ZIP_DEFLATED) as file:
        for name, table in found.items():
            file.writestr(f'{name}.csv', table.to_csv(index=False))
    disposition = 'attachment; filename="study.zip"'
    return HttpResponse(
        archive.getvalue(),
        content_type='application/zip',
        headers={'Content-Disposition': disposition},
    )
