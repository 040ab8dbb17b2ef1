# SPDX-License-Identifier: BSD-3-Clause
"""Reads what lcm-logger wrote of a live system, with the Python types that the build makes (BUILD/generated_python)."""
import importlib
import pathlib
import sys
import zlib

_TYPES = {"RUMI_SUBMAP": "chunk_t", "RUMI_SUBMAP_ACK": "chunk_ack_t", "RUMI_TRACK": "track_t",
          "RUMI_STATUS": "process_status_t", "RUMI_MAP_STATUS": "map_status_t", "CAMERA_TO_MAP": "rigid_transform_t"}


def use_types(build):
    sys.path.insert(0, str(pathlib.Path(build) / "generated_python"))


def message_type(name):
    return getattr(importlib.import_module(f"rumi.{name}"), name)


def events(log):
    """(seconds since the epoch, channel, message) of all that is known here, as it arrived."""
    types = {channel: message_type(name) for channel, name in _TYPES.items()}
    with importlib.import_module("rumi").lcm.EventLog(log) as file:
        for event in file:
            if event.channel in types:
                yield event.timestamp * 1e-6, event.channel, types[event.channel].decode(event.data)
        if file.skipped_bytes:
            raise ValueError(f"{log}: {file.skipped_bytes} bytes in it are no events")


class Update:
    """Of a submap_update_t, what it is about; the log of a long run has gigabytes of them."""

    def __init__(self, update):
        self.key = (update.session, update.submap_id)
        self.is_back = update.kind == update.BACK
        self.base_revision, self.revision = update.base_revision, update.revision
        self.told = {"keyframes": {k.id for k in update.keyframes}, "landmarks": {l.id for l in update.landmarks},
                     "frames": {f.utime for f in update.frames}}
        self.removed = {"keyframes": set(update.removed_keyframes), "landmarks": set(update.removed_landmarks), "frames": set()}


class Transfers:
    """Puts the submap updates together again that went over the bus in chunks."""

    def __init__(self):
        self._parts = {}  # by (sender, transfer): {index: data}
        self._updates = {}

    def take(self, chunk):
        """The update, when this was the last chunk that it lacked."""
        key = (chunk.sender, chunk.transfer_id)
        if key in self._updates:
            return None
        parts = self._parts.setdefault(key, {})
        parts[chunk.index] = chunk.data
        if len(parts) < chunk.count:
            return None
        payload = b"".join(parts[i] for i in range(chunk.count))
        del self._parts[key]
        if len(payload) != chunk.total_size or zlib.crc32(payload) != chunk.checksum:
            return None
        self._updates[key] = Update(message_type("submap_update_t").decode(payload))
        return self._updates[key]

    def update(self, sender, transfer_id):
        return self._updates.get((sender, transfer_id))
