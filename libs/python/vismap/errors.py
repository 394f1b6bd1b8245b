"""The exceptions of this package. Their texts say what was expected, what was found, and what to do."""


class VismapError(Exception):
    """The base of all errors of this package."""


class MessageError(VismapError):
    """Bytes are not a valid message, or a message cannot be encoded."""


class BusError(VismapError):
    """There is no connection to the bus, or it was lost."""


class WaitTimeout(VismapError, TimeoutError):
    """What was waited for did not come in time."""


class RequestError(VismapError):
    """A process of vismap has refused a request."""


class LogError(VismapError):
    """A log of LCM messages is damaged or cannot be read."""


class MapError(VismapError):
    """A map file, an octree or an update of a map is damaged or inconsistent."""
