"""What can be wrong with a stored file."""


class StorageError(Exception):
    """A file that must not be used; the message names it and says why."""


class DamagedFile(StorageError):
    """A file that is not what was written there: damaged, truncated or another's. It can be made again."""
