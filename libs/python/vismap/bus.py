"""A connection to the bus: publish, and subscribe by channel or pattern. See Bus."""
from __future__ import annotations

import collections
import logging
import os
import re
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Iterator

from . import messages
from .errors import BusError, MessageError, WaitTimeout
from .lcm_types import Message
from .transports import Transport, check_channel_prefix, open_transport, parse_url

_log = logging.getLogger("vismap")
_REJOIN_S = 0.25  # between two attempts to connect again
_TURN_S = 0.1  # the reading thread looks at least so often whether it shall end


def now_utime() -> int:
    """The wall clock [us since 1970]: the time base of `utime` in all messages."""
    return time.time_ns() // 1000


@dataclass(frozen=True)
class Received:
    """A message that has arrived."""

    channel: str
    data: bytes
    received_utime: int  # by the clock of this computer [us]

    def decode(self) -> Any:
        """The message. Raises MessageError when it is none of vismap's, or damaged."""
        return messages.decode(self.data)


class Subscription:
    """The messages of one subscription that have not been taken yet, oldest first. The queue is bounded: when it is
    full the oldest message is dropped and counted in `dropped`."""

    def __init__(self, bus: Bus, pattern: str, capacity: int, max_bytes: int) -> None:
        if capacity < 1:
            raise ValueError("capacity must be at least 1")
        self.pattern = pattern
        self.dropped = 0
        self.rejected = 0  # messages that were larger than their channel allows
        self._bus = bus
        self._matches = re.compile(pattern).fullmatch
        self._capacity, self._max_bytes = capacity, max_bytes
        self._queue: collections.deque[Received] = collections.deque()
        self._bytes = 0
        self._changed = threading.Condition()
        self._closed = False

    def get(self, timeout: float | None = None) -> Received:
        """The next message. Waits for it, at most `timeout` [s]; then raises WaitTimeout."""
        message = self.poll(timeout)
        if message is None:
            raise WaitTimeout(f"no message came on {self.pattern} within {timeout:g} s on {self._bus.url}; "
                              "vismap-doctor says what flows on this bus")
        return message

    def poll(self, timeout: float | None = 0.0) -> Received | None:
        """The next message; None when there is none within `timeout` [s]. Raises BusError when the bus was closed."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._queue) or self._closed, timeout)
            if not self._queue:
                if self._closed:
                    raise BusError(f"the subscription to {self.pattern} was closed")
                return None
            message = self._queue.popleft()
            self._bytes -= len(message.data)
            return message

    def latest(self, timeout: float | None = None) -> Received:
        """The newest message, and forgets the older ones. Waits as get() does."""
        message = self.get(timeout)
        while (newer := self.poll()) is not None:
            message = newer
        return message

    def __iter__(self) -> Iterator[tuple[str, Any]]:
        """Channel and decoded message, one after the other, until the bus is closed. A message that cannot be decoded
        raises MessageError; a `for` loop then ends, and may be started again for the next message."""
        while True:
            try:
                received = self.get()
            except BusError:
                return
            yield received.channel, received.decode()

    def close(self) -> None:
        """Ends the subscription. Messages that have arrived can still be taken."""
        self._bus._remove(self)
        self._end()

    def _matches_channel(self, channel: str) -> bool:
        return self._matches(channel) is not None

    def _add(self, message: Received) -> None:
        with self._changed:
            if len(message.data) > messages.max_bytes_of(message.channel):
                self.rejected += 1
                return
            self._queue.append(message)
            self._bytes += len(message.data)
            while len(self._queue) > self._capacity or (self._bytes > self._max_bytes and len(self._queue) > 1):
                self._bytes -= len(self._queue.popleft().data)
                self.dropped += 1
            self._changed.notify_all()

    def _end(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class Bus:
    """A connection to the bus, for use by any number of threads. A thread of its own receives. When the connection to a
    hub is lost it connects again, with all subscriptions; meanwhile `publish` raises BusError.

    url: tcpq://A.B.C.D:PORT or udpm://...; None = $LCM_DEFAULT_URL, else the hub at tcpq://127.0.0.1:7700.
    name: the `source` of the messages that are published. It must be unique on the bus.
    connect_timeout_s: how long to wait for the hub; then BusError says how to start one.
    channel_prefix: stands before the names of all channels on the bus, as the option --channel-prefix of vismap's programs;
    all functions take and give the names without it. Channels without the prefix need a Bus of their own.
    """

    def __init__(self, url: str | None = None, name: str = "", connect_timeout_s: float = 10.0,
                 channel_prefix: str = "") -> None:
        self._url = parse_url(url)
        check_channel_prefix(channel_prefix)
        self.channel_prefix = channel_prefix
        self.url = self._url.text
        self.name = name or f"python-{os.getpid()}"
        self.published: collections.Counter[str] = collections.Counter()  # messages by channel
        self.unsent: collections.Counter[str] = collections.Counter()  # not sent: no connection, or too large
        self.received: collections.Counter[str] = collections.Counter()
        self.reconnects = 0
        self._seq: collections.Counter[str] = collections.Counter()
        self._lock = threading.RLock()  # of what follows
        self._order = threading.Lock()  # so that messages leave in the order of their numbers
        self._subscriptions: list[Subscription] = []
        self._closing = threading.Event()
        self._transport: Transport | None = self._connect(connect_timeout_s)
        self._thread = threading.Thread(target=self._receive, name=f"vismap bus {self.name}", daemon=True)
        self._thread.start()

    @property
    def connected(self) -> bool:
        """Whether there is a connection at present."""
        return self._transport is not None

    def subscribe(self, pattern: str, capacity: int = 100, max_queue_mb: int = 256) -> Subscription:
        """The messages of all channels whose whole names match a regular expression, such as "OBJECTS" or "MAP_.*".

        capacity, max_queue_mb: how many messages wait at most. When there are more, the oldest is dropped.
        """
        try:
            subscription = Subscription(self, pattern, capacity, max_queue_mb << 20)
        except re.error as error:
            raise BusError(f"the pattern '{pattern}' is no regular expression: {error}") from None
        with self._lock:
            if self._closing.is_set():
                raise BusError("the bus was closed")
            known = any(other.pattern == pattern for other in self._subscriptions)
            self._subscriptions.append(subscription)
            if self._transport is not None and not known:
                try:
                    self._transport.subscribe(pattern)
                except BusError as error:
                    _log.info("%s; it subscribes again when the connection is back", error)
        return subscription

    def publish(self, channel: str, message: Message) -> None:
        """Publishes a message; fills in its `seq`, `source` and checksum, and `utime` if that is 0.

        Raises MessageError when the message is inconsistent or has not the type of the channel, and BusError when there
        is no connection or the message is larger than the channel allows. Only messages that were handed over to the
        connection have a number, so that readers see no gap for one that was not.
        """
        known = messages.CHANNELS.get(channel)
        if known is not None and message.TYPE != known.type:
            raise MessageError(f"{channel} carries {known.type}, not {message.TYPE}")
        fields: Any = message
        with self._order:
            if message.FIELDS[0].name == "utime" and fields.utime == 0:
                fields.utime = now_utime()
            if any(entry.name == "seq" for entry in message.FIELDS):
                fields.seq, fields.source = self._seq[channel], self.name
            self.publish_bytes(channel, messages.encode(message))
            self._seq[channel] += 1

    def publish_bytes(self, channel: str, data: bytes) -> None:
        """Publishes the bytes of a message as they are, to pass on messages of others."""
        with self._lock:
            transport = self._transport
        try:
            if transport is None:
                raise BusError(f"{channel}: not sent, since there is no connection to {self.url} at present; "
                               "it is tried again all the time")
            transport.publish(channel, data)
        except BusError:
            self.unsent[channel] += 1
            raise
        self.published[channel] += 1

    def close(self) -> None:
        """Ends the connection and all subscriptions."""
        self._closing.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()
        with self._lock:
            if self._transport is not None:
                self._transport.close()
            self._transport = None
            for subscription in self._subscriptions:
                subscription._end()

    def __enter__(self) -> Bus:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _connect(self, timeout: float) -> Transport:
        end = time.monotonic() + timeout
        while True:
            try:
                transport = open_transport(self._url, max(0.1, min(1.0, timeout)), self.channel_prefix)
                warning = getattr(transport, "warning", "")
                if warning:
                    _log.warning("%s", warning)
                return transport
            except BusError:
                if self._url.provider != "tcpq" or time.monotonic() + _REJOIN_S > end or self._closing.wait(_REJOIN_S):
                    raise

    def _remove(self, subscription: Subscription) -> None:
        with self._lock:
            if subscription not in self._subscriptions:
                return
            self._subscriptions.remove(subscription)
            if self._transport is not None and all(s.pattern != subscription.pattern for s in self._subscriptions):
                try:
                    self._transport.unsubscribe(subscription.pattern)
                except BusError:
                    pass  # the connection has ended, and with it the subscription

    def _receive(self) -> None:
        while not self._closing.is_set():
            transport = self._transport
            if transport is None:
                self._rejoin()
                continue
            try:
                arrived = transport.receive(_TURN_S)
            except BusError as error:
                if not self._closing.is_set():
                    _log.warning("%s; trying to connect to %s again", error, self.url)
                with self._lock:
                    self._transport = None
                transport.close()
                continue
            for channel, data in arrived:
                self._dispatch(Received(channel, data, now_utime()))

    def _rejoin(self) -> None:
        try:
            transport = open_transport(self._url, 1.0, self.channel_prefix)
            with self._lock:
                for pattern in {subscription.pattern for subscription in self._subscriptions}:
                    transport.subscribe(pattern)
                self._transport = transport
        except BusError:
            self._closing.wait(_REJOIN_S)
            return
        self.reconnects += 1
        _log.info("connected to %s again", self.url)

    def _dispatch(self, message: Received) -> None:
        self.received[message.channel] += 1
        with self._lock:
            subscriptions = list(self._subscriptions)
        for subscription in subscriptions:
            if subscription._matches_channel(message.channel):
                subscription._add(message)
