# SPDX-License-Identifier: BSD-3-Clause
"""LCM's datagrams: a message is one of them, or several where it is large. UDP may lose any; that is counted."""
import collections
import struct

_SHORT = struct.Struct(">II")  # magic, sequence
_LONG = struct.Struct(">IIIIHH")  # magic, sequence, size of all data, offset of this fragment's, its number, count
_SHORT_MAGIC, _LONG_MAGIC = 0x4C433032, 0x4C433033  # "LC02", "LC03"
_MAX_SHORT = 65499  # bytes after the header
_MAX_FRAGMENT = 65487
_MAX_FRAGMENTS = 0xFFFF
MAX_CHANNEL = 63
MAX_DATAGRAM = 65535

_SEQUENCES = 1 << 32
_MAX_GAP = 1_000_000  # a larger step is another count, not a loss
_MAX_LATE = 100  # messages that one may come after; what is older is of a sender that was started again
_MAX_SENDERS = 1000
_MAX_HELD = 1 << 28  # bytes of messages that came in part
_FRAGMENT_COST = 200  # bytes that Python takes for a fragment, however small


def split(sequence, channel, data):
    """The datagrams of a message; `channel` and `data` are bytes."""
    if b"\0" in channel or not 0 < len(channel) <= MAX_CHANNEL:
        raise ValueError(f"{channel!r}: a channel's name has 1 to {MAX_CHANNEL} bytes, none of them 0")
    sequence %= _SEQUENCES
    name = channel + b"\0"
    size = len(name) + len(data)
    if size <= _MAX_SHORT:
        return [_SHORT.pack(_SHORT_MAGIC, sequence) + name + data]
    count = -(-size // _MAX_FRAGMENT)
    if count > _MAX_FRAGMENTS:
        raise ValueError(f"{len(data)} bytes are too many for a message of LCM")
    datagrams = []
    for number in range(count):
        begin = max(0, number * _MAX_FRAGMENT - len(name))
        end = (number + 1) * _MAX_FRAGMENT - len(name)
        header = _LONG.pack(_LONG_MAGIC, sequence, len(data), begin, number, count)
        datagrams.append(header + (name if number == 0 else b"") + data[begin:end])
    return datagrams


def _channel_and_rest(piece):
    """(channel, what follows), or None."""
    end = piece.find(b"\0", 0, MAX_CHANNEL + 1)
    return (piece[:end].decode(errors="backslashreplace"), piece[end + 1:]) if end > 0 else None


class _Partial:
    """A message of which fragments are missing."""

    def __init__(self, key, is_newest):
        self.key, self.is_newest = key, is_newest  # key: sequence, size, count
        self.channel, self.pieces, self.held = None, {}, 0

    def joined(self):
        """(channel, data); None if the fragments do not fit one another."""
        data = bytearray()
        for number in range(len(self.pieces)):
            offset, piece = self.pieces[number]
            if offset != len(data):
                return None
            data += piece
        return (self.channel, bytes(data)) if len(data) == self.key[1] else None


class _Sender:
    def __init__(self):
        self.last, self.partial = None, None


class Assembler:
    """Datagrams in, messages out. Nothing that comes in is an error, or makes it hold more than some 256 MiB."""

    def __init__(self):
        self.lost = 0  # messages that were sent, and did not arrive whole
        self.not_lcm = 0  # datagrams
        self._senders = collections.OrderedDict()  # who was silent for longest comes first
        self._held = 0

    def take(self, address, datagram):
        """(channel, data) if it was the last piece of a message, else None."""
        magic = int.from_bytes(datagram[:4], "big")
        if magic == _SHORT_MAGIC and (message := _channel_and_rest(datagram[_SHORT.size:])):
            self._note(self._sender(address), _SHORT.unpack_from(datagram)[1])
            return message
        if magic == _LONG_MAGIC and len(datagram) > _LONG.size:
            return self._take_fragment(address, _LONG.unpack_from(datagram)[1:], datagram[_LONG.size:])
        self.not_lcm += 1
        return None

    def _take_fragment(self, address, header, piece):
        sequence, size, offset, number, count = header
        channel = None
        if number == 0:
            channel, piece = _channel_and_rest(piece) or (None, piece)
        if number >= count or offset + len(piece) > size or (number == 0 and channel is None):
            self.not_lcm += 1
            return None
        sender = self._sender(address)
        partial = self._partial(sender, (sequence, size, count))
        if partial is None or number in partial.pieces:
            return None  # late, or twice
        partial.channel = channel or partial.channel
        partial.pieces[number] = (offset, piece)
        partial.held += len(piece) + _FRAGMENT_COST
        self._held += len(piece) + _FRAGMENT_COST
        if len(partial.pieces) < count:
            self._make_room()
            return None
        self._forget_partial(sender, is_lost=False)
        message = partial.joined()
        if message is None:
            self.not_lcm += count
        return message

    def _partial(self, sender, key):
        if sender.partial and sender.partial.key == key:
            return sender.partial
        is_newest = self._is_newer(sender, key[0])
        if sender.partial and not is_newest:
            return None
        self._note(sender, key[0])
        sender.partial = _Partial(key, is_newest)
        return sender.partial

    def _sender(self, address):
        sender = self._senders.setdefault(address, _Sender())
        self._senders.move_to_end(address)
        if len(self._senders) > _MAX_SENDERS:
            _, silent = self._senders.popitem(last=False)
            self._forget_partial(silent)
        return sender

    @staticmethod
    def _is_newer(sender, sequence):
        return sender.last is None or (sender.last - sequence) % _SEQUENCES >= _MAX_LATE

    def _note(self, sender, sequence):
        """A message of this sequence has come, or begun: what was to come before it, and did not, is lost."""
        if not self._is_newer(sender, sequence):
            return
        self._forget_partial(sender)
        if sender.last is not None:
            gap = (sequence - sender.last) % _SEQUENCES - 1
            self.lost += gap if gap < _MAX_GAP else 0
        sender.last = sequence

    def _forget_partial(self, sender, is_lost=True):
        if sender.partial:
            self._held -= sender.partial.held
            self.lost += is_lost and sender.partial.is_newest
            sender.partial = None

    def _make_room(self):
        for sender in list(self._senders.values()) if self._held > _MAX_HELD else []:
            self._forget_partial(sender)
            if self._held <= _MAX_HELD:
                return
