# SPDX-License-Identifier: BSD-3-Clause
"""The multicast bus, in the thread that asks: what is not yet handled waits in the socket's buffer."""
import ipaddress
import math
import os
import re
import socket
import struct
import time
import urllib.parse
import warnings
from typing import NamedTuple

from .datagrams import MAX_DATAGRAM, Assembler, split
from .messages import decode

# That of Rumi's programs: it does not leave the machine (ttl=0), and has room for raw images.
DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152"

_MAX_LATE = 1000  # datagrams that are taken when the time is over


class _Address(NamedTuple):
    group: str = "239.255.76.67"
    port: int = 7667
    ttl: int = 0
    recv_buf_size: int = 2097152


def _number(url, name, text, largest):
    if not re.fullmatch(r"[0-9]{1,10}", text) or int(text) > largest:
        raise ValueError(f"{url}: {name} is {text!r}, not a number from 0 to {largest}")
    return int(text)


def _parse(url):
    scheme, separator, rest = url.partition("://")
    if scheme != "udpm" or not separator:
        raise ValueError(f"{url}: not the URL of a multicast bus, such as {DEFAULT_URL} (for a log: rumi.lcm.EventLog)")
    where, _, options = rest.partition("?")
    group, _, port = where.rstrip("/").partition(":")
    parts = {}
    if group:
        try:
            is_multicast = ipaddress.IPv4Address(group).is_multicast
        except ValueError:
            is_multicast = False
        if not is_multicast:
            raise ValueError(f"{url}: {group} is not a multicast address (224.0.0.0 to 239.255.255.255)")
        parts["group"] = group
    if port:
        parts["port"] = _number(url, "the port", port, 65535)
    limits = {"ttl": 255, "recv_buf_size": 2**31 - 1}
    for name, value in urllib.parse.parse_qsl(options, keep_blank_values=True):
        if name in limits:
            parts[name] = _number(url, name, value, limits[name])
        else:
            warnings.warn(f"{url}: the option {name} is not known, and does nothing", stacklevel=3)
    return _Address(**parts)


class Subscription:
    def __init__(self, channel, handler, message_type):
        self.pattern, self.handler, self.message_type = re.compile(channel), handler, message_type


class LCM:
    """Messages from and to the bus at `url`; without one, that in LCM_DEFAULT_URL, or Rumi's.

    `received` messages were handed on; `undecodable` ones were no messages of the type that the subscription names. `lost`
    messages never came, or not all their pieces; `not_lcm` counts datagrams of others. None of that is an exception.
    """

    def __init__(self, url=None):
        self.url = url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
        self.received = self.undecodable = 0
        self._address = _parse(self.url)
        self._assembler = Assembler()
        self._subscriptions = []
        self._sequence = 0
        self._receiver = None
        self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, self._address.ttl)
            self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            self._sender.connect((self._address.group, self._address.port))
        except OSError as error:
            self._sender.close()
            raise self._explained(error) from error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def lost(self):
        return self._assembler.lost

    @property
    def not_lcm(self):
        return self._assembler.not_lcm

    def close(self):
        self._sender.close()
        if self._receiver:
            self._receiver.close()

    def subscribe(self, channel, handler, message_type=None):
        """`handler(channel, message)` for each message whose channel is `channel`, a regular expression as in LCM.

        With a `message_type`, such as rumi.rigid_transform_t, messages are decoded; without one they are bytes.
        """
        self.fileno()
        self._subscriptions.append(Subscription(channel, handler, message_type))
        return self._subscriptions[-1]

    def unsubscribe(self, subscription):
        self._subscriptions.remove(subscription)

    def publish(self, channel, message):
        """`message` is bytes, or has encode()."""
        data = message.encode() if hasattr(message, "encode") else bytes(message)
        for datagram in split(self._sequence, channel.encode(), data):
            self._sender.send(datagram)
        self._sequence += 1

    def handle(self):
        """Waits for a message that was subscribed to, and calls its handlers."""
        if not self._subscriptions:
            raise RuntimeError("handle() would wait for ever: there is no subscription")
        self._handle_before(math.inf)

    def handle_timeout(self, milliseconds):
        """handle() that waits so long at most; whether there was a message."""
        return self._handle_before(time.monotonic() + milliseconds * 1e-3)

    def fileno(self):
        """Readable when there may be a message, for select()."""
        if not self._receiver:
            self._receiver = self._open_receiver()
        return self._receiver.fileno()

    def _handle_before(self, deadline):
        self.fileno()
        handled, late = False, 0
        while not handled and late <= _MAX_LATE:
            seconds = max(0, deadline - time.monotonic())
            late += seconds == 0  # what is there already is taken, unless it has no end
            self._receiver.settimeout(None if seconds == math.inf else seconds)
            try:
                datagram, sender = self._receiver.recvfrom(MAX_DATAGRAM)
            except (TimeoutError, BlockingIOError):
                break
            message = self._assembler.take(sender, datagram)
            handled = message is not None and self._hand_on(*message)
        return handled

    def _hand_on(self, channel, data):
        wanted_by = [s for s in self._subscriptions if s.pattern.fullmatch(channel)]
        self.received += bool(wanted_by)
        handled = False
        for subscription in wanted_by:
            message = data
            if subscription.message_type:
                try:
                    message = decode(data, subscription.message_type)
                except ValueError:
                    self.undecodable += 1
                    continue
            subscription.handler(channel, message)
            handled = True
        return handled

    def _open_receiver(self):
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if hasattr(socket, "SO_REUSEPORT"):
                receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, self._address.recv_buf_size)
            # Bound to the group, it does not hear what others send to another group at this port.
            receiver.bind((self._address.group, self._address.port))
            membership = struct.pack("=4sI", socket.inet_aton(self._address.group), socket.INADDR_ANY)
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        except OSError as error:
            receiver.close()
            raise self._explained(error) from error
        return receiver

    def _explained(self, error):
        return OSError(error.errno, f"the LCM bus {self.url} cannot be used: {error.strerror}. Is there a multicast route? "
                                    "On one machine these two commands set it up:\n  sudo ip link set lo multicast on\n"
                                    f"  sudo ip route add {self._address.group}/32 dev lo")
