# SPDX-License-Identifier: BSD-3-Clause
"""Log files as lcm-logger writes and lcm-logplayer reads them."""
import os
import struct
from typing import NamedTuple

_HEADER = struct.Struct(">IqqII")  # sync word, number, time, sizes of channel and data
_SYNC = 0xEDA1DA01
_SYNC_BYTES = struct.pack(">I", _SYNC)
_MAX_CHANNEL = 63
_LEAST_SEARCHED, _MOST_SEARCHED = 1 << 12, 1 << 20  # at once


class Event(NamedTuple):
    eventnum: int
    timestamp: int  # microseconds since the epoch: when it was received
    channel: str
    data: bytes  # see rumi.lcm.decode


class EventLog:
    """Iterate over it for its events, or write_event() with mode "w". The file is closed at the end of a `with`.

    What of a log is damaged is passed over and counted: `skipped_bytes` between events, and `cut_off_bytes` at the end, of
    an event that a logger did not finish. A file that is no log is a ValueError.
    """

    def __init__(self, path, mode="r", overwrite=False):
        if mode not in ("r", "w"):
            raise ValueError(f"{path}: a log is opened with mode r or w, not {mode}")
        self.path, self.skipped_bytes, self.cut_off_bytes = os.fspath(path), 0, 0
        self._next_number = 0
        self._file = open(path, "rb" if mode == "r" else "wb" if overwrite else "xb")
        if mode == "w":
            return
        first = self._file.read(len(_SYNC_BYTES))
        self._file.seek(0)
        if first != _SYNC_BYTES[:len(first)] and self.read_next_event() is None:
            self._file.close()
            raise ValueError(f"{self.path}: not an LCM log, there is no event in it")
        self._file.seek(0)
        self.skipped_bytes = self.cut_off_bytes = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __iter__(self):
        while (event := self.read_next_event()) is not None:
            yield event

    def close(self):
        self._file.close()

    def read_next_event(self):
        """The next event; None at the end, where one may go on later if somebody still writes the log."""
        while True:
            start = self._file.tell()
            header = self._file.read(_HEADER.size)
            if len(header) == _HEADER.size and header.startswith(_SYNC_BYTES):
                _, number, time, channel_size, size = _HEADER.unpack(header)
                end = start + _HEADER.size + channel_size + size
                if channel_size <= _MAX_CHANNEL and end <= os.fstat(self._file.fileno()).st_size:
                    self.cut_off_bytes = 0
                    channel = self._file.read(channel_size).decode(errors="backslashreplace")
                    return Event(number, time, channel, self._file.read(size))
            elif not header:
                return None
            self._file.seek(start + 1)
            found = self._find_sync()
            if found is None:
                self._file.seek(0, os.SEEK_END)
                self.cut_off_bytes = self._file.tell() - start
                self._file.seek(start)
                return None
            self.skipped_bytes += found - start
            self._file.seek(found)

    def write_event(self, timestamp, channel, data):
        """`data` is bytes, or a message."""
        data = data.encode() if hasattr(data, "encode") else data
        name = channel.encode()
        if len(name) > _MAX_CHANNEL:
            raise ValueError(f"{channel}: a channel's name has at most {_MAX_CHANNEL} bytes")
        self._file.write(_HEADER.pack(_SYNC, self._next_number, timestamp, len(name), len(data)) + name)
        self._file.write(data)
        self._next_number += 1

    def _find_sync(self):
        """Where the next event begins, from where the file is read; None if there is none."""
        before, at, size = b"", self._file.tell(), _LEAST_SEARCHED
        while piece := self._file.read(size):
            size = min(2 * size, _MOST_SEARCHED)
            searched = before + piece
            found = searched.find(_SYNC_BYTES)
            if found >= 0:
                return at - len(before) + found
            at += len(piece)
            before = searched[-len(_SYNC_BYTES) + 1:]
        return None
