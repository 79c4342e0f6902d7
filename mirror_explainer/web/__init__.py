"""What all pages of the package share: a small, offline web server around Django.

A page is a Django app: a package with urls.py, templates/ (each extends base.html) and
static/ (each file is served as `{% static 'name' %}`). A command names it and serves it:

    add_address_arguments(parser, port=8080)
    configure(Site('operator', 'mirror_explainer.web.operator'), at := address(options))
    serve(at)
"""
