"""What can be wrong with a stored file."""


class StorageError(Exception):
    """A file that must not be used; the message names it and says why."""
