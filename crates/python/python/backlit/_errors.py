"""What goes wrong. Every message is what the command line says; ``__cause__`` is what lies below it."""


class Error(Exception):
    """Something could not be done. Base of all exceptions of this package."""


class InputError(Error, ValueError):
    """An argument is not as expected: the message names it, what was expected and what came."""


class FileError(Error, OSError):
    """A file could not be read or written: the message names file, line or field."""


BacklitError = Error
for _class in (Error, InputError, FileError):
    _class.__module__ = "backlit"
