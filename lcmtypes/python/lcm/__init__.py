# SPDX-License-Identifier: BSD-3-Clause
"""LCM in Python alone: logs (EventLog) and the multicast bus (LCM), with the names that LCM's own package has.

`import rumi` has it as rumi.lcm. A program written for LCM's own package needs `from rumi import lcm` only.
"""
from .bus import DEFAULT_URL, LCM, Subscription
from .event_log import Event, EventLog
from .messages import decode

__all__ = ["DEFAULT_URL", "Event", "EventLog", "LCM", "Subscription", "decode"]
