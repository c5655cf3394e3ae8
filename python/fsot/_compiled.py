"""That the compiled half is there, or what to do."""

try:
    from ._fsot import __version__ as __version__
except ModuleNotFoundError as missing:
    if missing.name != "fsot._fsot":
        raise
    raise ImportError(
        f"{__file__} belongs to the sources of fsot, whose compiled half is not here: run Python in another "
        "folder to use what is installed, or 'pip install --editable' the folder above to use these"
    ) from None
