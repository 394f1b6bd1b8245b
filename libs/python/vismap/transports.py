"""The two ways in which LCM messages travel: over TCP to a hub (tcpq), and by multicast (udpm)."""
from __future__ import annotations

import os
import re
import select
import socket
import struct
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Protocol
from urllib.parse import parse_qsl

from .errors import BusError
from .messages import CHANNELS, MAX_MESSAGE_BYTES, max_bytes_of

DEFAULT_URL = "tcpq://127.0.0.1:7700"
_MAX_CHANNEL = 63  # the longest channel name that LCM sends [bytes]
_SEND_TIMEOUT_S = 90.0  # without progress; longer than the patience of a hub
_READ_BYTES = 1 << 20  # at most in one step

_CLIENT, _HUB, _VERSION = 0x287617fb, 0x287617fa, 0x0100  # greetings of tcpq
_PUBLISH, _SUBSCRIBE, _UNSUBSCRIBE = 1, 2, 3


@dataclass(frozen=True)
class Url:
    """A checked LCM URL."""

    text: str
    provider: str  # "tcpq" or "udpm"
    host: str
    port: int
    ttl: int = 0
    receive_buffer: int = 4 << 20  # [bytes]


def parse_url(text: str | None = None) -> Url:
    """Checks a URL such as tcpq://127.0.0.1:7700 or udpm://239.255.76.67:7667?ttl=1.

    None stands for $LCM_DEFAULT_URL, or tcpq://127.0.0.1:7700 if that is not set. Raises BusError on everything that LCM
    would misunderstand: it takes host names for this computer, for example.
    """
    text = text or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
    found = re.fullmatch(r"(\w+)://([^/?:]*)(?::(\d+))?/?(?:\?(.*))?", text)
    if not found or found.group(1) not in ("tcpq", "udpm"):
        raise BusError(f"the URL '{text}' was not understood; expected tcpq://127.0.0.1:7700 or udpm://239.255.76.67:7667?ttl=0")
    provider, host, port, query = found.groups()
    default_host, default_port = ("127.0.0.1", 7700) if provider == "tcpq" else ("239.255.76.67", 7667)
    host, number = host or default_host, int(port or default_port)
    try:
        socket.inet_pton(socket.AF_INET, host)
    except OSError:
        raise BusError(f"the URL '{text}' has the host '{host}'; expected a numeric address such as 127.0.0.1, since other "
                       "LCM programs do not resolve names") from None
    if number > 65535:
        raise BusError(f"the URL '{text}' has the port {number}; expected at most 65535")
    options = dict(parse_qsl(query or "", keep_blank_values=True))
    numbers = {"ttl": 0, "recv_buf_size": 4 << 20}
    for key in numbers:
        if key in options:
            if not options[key].isdigit():
                raise BusError(f"the URL '{text}': {key} must be a number")
            numbers[key] = int(options[key])
    return Url(text, provider, host, number, numbers["ttl"], numbers["recv_buf_size"])


class Transport(Protocol):
    """A connection to the bus. One thread receives; any thread publishes and subscribes."""

    def subscribe(self, pattern: str) -> None: ...
    def unsubscribe(self, pattern: str) -> None: ...
    def publish(self, channel: str, data: bytes) -> None: ...

    def receive(self, timeout: float) -> list[tuple[str, bytes]]:
        """Waits up to `timeout` [s]; returns the messages that are complete. Raises BusError when the connection has
        ended."""

    def close(self) -> None: ...


def open_transport(url: Url, timeout: float, channel_prefix: str = "") -> Transport:
    """Connects; for a hub within `timeout` [s]. All channels have the prefix on the bus."""
    transport: Transport
    if url.provider == "tcpq":
        transport = TcpqTransport(url, timeout)
    else:
        transport = UdpmTransport(url)
    return PrefixedTransport(transport, channel_prefix) if channel_prefix else transport


def check_channel_prefix(prefix: str) -> None:
    """Raises BusError when a prefix cannot stand before the names of vismap's channels."""
    if not re.fullmatch(r"[A-Za-z0-9_\-/.#]*", prefix):
        raise BusError(f"the prefix '{prefix}' has other characters than letters, digits, _ - / . and #")
    most = _MAX_CHANNEL - max(map(len, CHANNELS))
    if len(prefix) > most:
        raise BusError(f"the prefix '{prefix}' has {len(prefix)} characters, but at most {most} are allowed: LCM's names of "
                       f"channels have at most {_MAX_CHANNEL}")


class PrefixedTransport:
    """Puts a prefix before the names of all channels on the bus, and takes it off what is received. See Transport."""

    def __init__(self, transport: Transport, prefix: str) -> None:
        self._transport, self._prefix = transport, prefix
        self.warning: str = getattr(transport, "warning", "")

    def _expression(self, pattern: str) -> str:
        return f"{re.escape(self._prefix)}(?:{pattern})"

    def subscribe(self, pattern: str) -> None:
        self._transport.subscribe(self._expression(pattern))

    def unsubscribe(self, pattern: str) -> None:
        self._transport.unsubscribe(self._expression(pattern))

    def publish(self, channel: str, data: bytes) -> None:
        _check_size(channel, len(data))
        self._transport.publish(self._prefix + channel, data)

    def receive(self, timeout: float) -> list[tuple[str, bytes]]:
        return [(channel[len(self._prefix):], data) for channel, data in self._transport.receive(timeout)
                if channel.startswith(self._prefix)]

    def close(self) -> None:
        self._transport.close()


def _channel_bytes(channel: str) -> bytes:
    name = channel.encode()
    if not 1 <= len(name) <= _MAX_CHANNEL or b"\0" in name:
        raise BusError(f"the channel name '{channel}' has {len(name)} bytes; expected 1 to {_MAX_CHANNEL}, without NUL")
    return name


def _check_size(channel: str, size: int) -> None:
    most = max_bytes_of(channel)
    if size > most:
        raise BusError(f"{channel}: a message of {size} bytes was not sent; readers accept at most {most} bytes")


class RecordReader:
    """Cuts the stream of a hub into messages. It holds what has arrived, not what the sender announces."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def add(self, data: bytes) -> list[tuple[str, bytes]]:
        """The messages that `data` completes. Raises BusError when the bytes violate the protocol."""
        self._buffer += data
        messages, at = [], 0
        while (record := self._record(at)) is not None:
            channel, begin, end = record
            messages.append((channel, bytes(memoryview(self._buffer)[begin:end])))
            at = end
        del self._buffer[:at]
        return messages

    def _record(self, at: int) -> tuple[str, int, int] | None:
        """Channel of the message at an offset, and where its data begin and end; None = it has not arrived completely."""
        have = len(self._buffer) - at
        if have < 8:
            return None
        kind, name_size = struct.unpack_from(">II", self._buffer, at)
        if kind != _PUBLISH or name_size > 1024:
            raise BusError(f"the hub sent a record of kind {kind} with a name of {name_size} bytes; is it a hub of LCM?")
        if have < 12 + name_size:
            return None
        (data_size,) = struct.unpack_from(">I", self._buffer, at + 8 + name_size)
        if data_size > MAX_MESSAGE_BYTES:
            raise BusError(f"the hub announces a message of {data_size} bytes; at most {MAX_MESSAGE_BYTES} are accepted")
        begin = at + 12 + name_size
        if len(self._buffer) - begin < data_size:
            return None
        return self._buffer[at + 8:at + 8 + name_size].decode("utf-8", "replace"), begin, begin + data_size


class TcpqTransport:
    """A connection to a hub: vismap-hub, or LCM's own TCPService. See Transport."""

    def __init__(self, url: Url, timeout: float) -> None:
        self._lock = threading.Lock()
        self._reader = RecordReader()
        self._closed = False
        try:
            self._socket = socket.create_connection((url.host, url.port), timeout)
        except OSError as error:
            raise BusError(f"there is no hub at {url.text} ({error}); start one with: "
                           f"vismap-hub --listen {url.host}:{url.port}") from None
        try:
            self._greet(url)
        except BaseException:
            self._socket.close()
            raise

    def _greet(self, url: Url) -> None:
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        answer = b""
        try:
            self._socket.sendall(struct.pack(">II", _CLIENT, _VERSION))
            while len(answer) < 8 and (more := self._socket.recv(8 - len(answer))):
                answer += more
        except OSError as error:
            raise BusError(f"{url.text}: it does not answer as a hub of LCM ({error})") from None
        if len(answer) < 8 or struct.unpack(">II", answer)[0] != _HUB:
            raise BusError(f"{url.text}: it does not answer as a hub of LCM; it sent {answer.hex() or 'nothing'}")
        self._socket.settimeout(_SEND_TIMEOUT_S)

    def _send(self, *parts: bytes) -> None:
        # After a part of a record the hub could not find the next one, so an error ends the connection.
        try:
            with self._lock:
                for part in parts:
                    self._socket.sendall(part)
        except OSError as error:
            self._shut_down()
            raise BusError(f"the connection to the hub was lost while sending ({error})") from None

    def subscribe(self, pattern: str) -> None:
        name = pattern.encode()
        self._send(struct.pack(">II", _SUBSCRIBE, len(name)) + name)

    def unsubscribe(self, pattern: str) -> None:
        name = pattern.encode()
        self._send(struct.pack(">II", _UNSUBSCRIBE, len(name)) + name)

    def publish(self, channel: str, data: bytes) -> None:
        name = _channel_bytes(channel)
        _check_size(channel, len(data))
        head = struct.pack(">II", _PUBLISH, len(name)) + name + struct.pack(">I", len(data))
        self._send(head + data) if len(data) < 65536 else self._send(head, data)

    def receive(self, timeout: float) -> list[tuple[str, bytes]]:
        try:
            if not select.select([self._socket], [], [], timeout)[0]:
                return []
            data = self._socket.recv(_READ_BYTES)
        except (OSError, ValueError) as error:
            raise BusError(f"the connection to the hub was lost ({error})") from None
        if not data:
            raise BusError("the hub has closed the connection")
        return self._reader.add(data)

    def _shut_down(self) -> None:
        try:
            self._socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass

    def close(self) -> None:
        # A socket that is closed with unread bytes takes back what it has sent last, so these are read first.
        try:
            self._socket.shutdown(socket.SHUT_WR)
            end = time.monotonic() + 1.0
            while time.monotonic() < end and select.select([self._socket], [], [], max(0.0, end - time.monotonic()))[0]:
                if not self._socket.recv(_READ_BYTES):
                    break
        except OSError:
            pass
        self._socket.close()


_SHORT, _LONG = 0x4c433032, 0x4c433033  # "LC02": a whole message; "LC03": a fragment of one
_MAX_SHORT, _MAX_FRAGMENT = 65499, 65487  # of channel and data, of a fragment's data [bytes]
_MAX_PARTIAL, _MAX_PARTIAL_BYTES = 64, 512 << 20  # messages of which fragments are missing


@dataclass
class _Partial:
    size: int  # of the whole message [bytes]
    count: int  # of its fragments
    channel: str | None = None
    parts: dict[int, tuple[int, bytes]] = field(default_factory=dict)  # number -> offset, data
    held: int = 0  # [bytes]


class Fragments:
    """Joins the datagrams of LCM's multicast into messages. It holds what has arrived, not what a sender announces;
    a fragment that comes twice does not stand for one that is missing."""

    def __init__(self) -> None:
        self._partial: OrderedDict[tuple[object, int], _Partial] = OrderedDict()
        self._held = 0
        self.rejected = 0  # datagrams that are none of LCM's, or contradict others

    def add(self, datagram: bytes, sender: object) -> tuple[str, bytes] | None:
        """The message that the datagram completes, as channel and data; None = none."""
        if len(datagram) < 8:
            return self._reject()
        magic, number = struct.unpack_from(">II", datagram)
        if magic == _SHORT:
            channel, end = self._channel(datagram, 8)
            return self._reject() if channel is None else (channel, datagram[end:])
        if magic != _LONG or len(datagram) < 20:
            return self._reject()
        return self._add_fragment(datagram, (sender, number))

    def _add_fragment(self, datagram: bytes, key: tuple[object, int]) -> tuple[str, bytes] | None:
        size, offset, index, count = struct.unpack_from(">IIHH", datagram, 8)
        begin, channel = 20, None
        if index == 0:
            channel, begin = self._channel(datagram, 20)
        data = datagram[begin:]
        partial = self._partial.setdefault(key, _Partial(size, count))
        if (size > MAX_MESSAGE_BYTES or index >= count or offset + len(data) > size or (index == 0 and channel is None)
                or (partial.size, partial.count) != (size, count)):
            self._drop(key)
            return self._reject()
        if index in partial.parts:
            return None
        partial.parts[index] = (offset, data)
        partial.channel = channel if index == 0 else partial.channel
        partial.held += len(data)
        self._held += len(data)
        if len(partial.parts) == count:
            self._drop(key)
            return self._join(partial)
        while len(self._partial) > _MAX_PARTIAL or self._held > _MAX_PARTIAL_BYTES:
            self._drop(next(iter(self._partial)))
        return None

    def _join(self, partial: _Partial) -> tuple[str, bytes] | None:
        whole, end = [], 0
        for _, (offset, data) in sorted(partial.parts.items()):
            if offset != end:
                return self._reject()
            whole.append(data)
            end += len(data)
        if end != partial.size or partial.channel is None:
            return self._reject()
        return partial.channel, b"".join(whole)

    def _drop(self, key: tuple[object, int]) -> None:
        self._held -= self._partial.pop(key).held

    def _reject(self) -> tuple[str, bytes] | None:
        self.rejected += 1
        return None

    @staticmethod
    def _channel(datagram: bytes, at: int) -> tuple[str | None, int]:
        end = datagram.find(b"\0", at, at + _MAX_CHANNEL + 1)
        return (None, at) if end < 0 else (datagram[at:end].decode("utf-8", "replace"), end + 1)


def datagrams(channel: str, data: bytes, number: int) -> list[bytes]:
    """The datagrams of one message; `number` counts the messages of the sender."""
    name = _channel_bytes(channel) + b"\0"
    if len(name) + len(data) <= _MAX_SHORT:
        return [struct.pack(">II", _SHORT, number) + name + data]
    count = -(-(len(name) + len(data)) // _MAX_FRAGMENT)
    if count > 65535:
        raise BusError(f"{channel}: a message of {len(data)} bytes is too large for multicast")
    sent, at = [], 0
    for index in range(count):
        begin = name if index == 0 else b""
        part = data[at:at + _MAX_FRAGMENT - len(begin)]
        sent.append(struct.pack(">IIIIHH", _LONG, number, len(data), at, index, count) + begin + part)
        at += len(part)
    return sent


class UdpmTransport:
    """LCM's multicast. See Transport. What the kernel or the network drops is lost."""

    def __init__(self, url: Url) -> None:
        self._address = (url.host, url.port)
        self._lock = threading.Lock()
        self._fragments = Fragments()
        self._number = 0
        self._patterns: set[str] = set()
        self._receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._open(url)
        except OSError as error:
            self.close()
            raise BusError(f"{url.text}: the multicast group cannot be joined ({error}); if there is no route, run: "
                           "sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo") from None

    def _open(self, url: Url) -> None:
        self._receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, url.receive_buffer)
        granted = self._receiver.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) // 2
        self.warning = "" if granted >= url.receive_buffer else (
            f"the kernel grants a receive buffer of {granted} instead of {url.receive_buffer} bytes, so large messages will "
            "be lost; run: sudo sysctl -w net.core.rmem_max=33554432")
        self._receiver.bind(self._address)
        group = socket.inet_aton(url.host) + struct.pack("=I", socket.INADDR_ANY)
        self._receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, url.ttl)
        self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        self._sender.connect(self._address)

    def subscribe(self, pattern: str) -> None:
        pass  # every message arrives; the bus selects

    def unsubscribe(self, pattern: str) -> None:
        pass

    def publish(self, channel: str, data: bytes) -> None:
        _check_size(channel, len(data))
        try:
            with self._lock:
                for datagram in datagrams(channel, data, self._number):
                    self._sender.send(datagram)
                self._number = (self._number + 1) & 0xffffffff
        except OSError as error:
            raise BusError(f"{channel}: a message could not be sent by multicast ({error})") from None

    def receive(self, timeout: float) -> list[tuple[str, bytes]]:
        messages: list[tuple[str, bytes]] = []
        end = time.monotonic() + timeout
        try:
            while select.select([self._receiver], [], [], max(0.0, end - time.monotonic()))[0]:
                datagram, sender = self._receiver.recvfrom(65536)
                message = self._fragments.add(datagram, sender)
                if message is not None:
                    messages.append(message)
                    end = 0.0  # what waits is taken, too
                if len(messages) >= 64:
                    break
        except (OSError, ValueError) as error:
            raise BusError(f"the multicast socket has failed ({error})") from None
        return messages

    def close(self) -> None:
        self._receiver.close()
        self._sender.close()
