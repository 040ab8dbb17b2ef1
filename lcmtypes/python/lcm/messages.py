# SPDX-License-Identifier: BSD-3-Clause
"""From bytes to messages: what lcm-gen makes trusts the lengths in a message, and takes a message that is cut off."""
import struct
import sys

_FINGERPRINT_SIZE = 8


class _Exact:
    """Bytes to read from; what is not there is an error."""

    def __init__(self, data):
        self._data, self._at = memoryview(data), 0

    def read(self, size):
        end = self._at + size
        if size < 0 or end > len(self._data):
            raise ValueError(f"{size} bytes are wanted at {self._at}, the message has {len(self._data)}")
        piece, self._at = self._data[self._at:end].tobytes(), end
        return piece


def _type_of(fingerprint):
    package = sys.modules[__package__.rpartition(".")[0]]
    for of_package in vars(package).values():
        if hasattr(of_package, "_get_packed_fingerprint") and of_package._get_packed_fingerprint() == fingerprint:
            return of_package
    raise ValueError(f"the fingerprint {fingerprint.hex()} is of no type of {package.__name__}")


def decode(data, message_type=None):
    """The message in these bytes: of `message_type`, or of the type of this package that has their fingerprint.

    ValueError where they are no such message: of another type or version, cut off, or broken.
    """
    fingerprint = bytes(data[:_FINGERPRINT_SIZE])
    message_type = message_type or _type_of(fingerprint)
    name, wanted = message_type.__name__, message_type._get_packed_fingerprint()
    if fingerprint != wanted:
        raise ValueError(f"no {name}: the fingerprint is {fingerprint.hex()}, not {wanted.hex()}")
    try:
        return message_type.decode(_Exact(data))
    except (ValueError, struct.error, OverflowError, MemoryError) as error:
        raise ValueError(f"a broken {name}: {error}") from error
