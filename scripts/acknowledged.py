# SPDX-License-Identifier: BSD-3-Clause
"""Is all in map.db that map_server said it had stored? Follows the acknowledged submap updates in a log of the bus, and
compares keyframes, landmarks and frames, by their ids, with what the file holds at the end."""
import sqlite3

from bus_log import Transfers

KINDS = ("keyframes", "landmarks", "frames")


class _Copy:
    """What a submap must hold, by its acknowledged updates, and what it may lack as a later update took it out."""

    def __init__(self):
        self.elements = {kind: set() for kind in KINDS}
        self.revision = 0
        self.is_back = False

    def apply(self, update):
        if update.revision <= self.revision:
            return
        if update.base_revision == 0:
            self.elements = {kind: set() for kind in KINDS}
        self.revision = update.revision
        self.is_back = update.is_back
        for kind in KINDS:
            self.elements[kind] -= update.removed[kind]
            self.elements[kind] |= update.told[kind]


class Acknowledged:
    """Feed it all events of the bus, then compare()."""

    def __init__(self):
        self.transfers = Transfers()
        self.updates = 0        # acknowledged
        self.unseen = 0         # acknowledged ones that the log does not have whole: only their revision is compared
        self.last_ack_s = None
        self._copies = {}       # by (session, submap)
        self._sent = {}         # by (session, submap): all updates, acknowledged or not
        self._done = set()
        self._unseen_revisions = []

    def take(self, time_s, channel, message):
        if channel == "RUMI_SUBMAP":
            update = self.transfers.take(message)
            if update:
                self._sent.setdefault(update.key, []).append(update)
        elif channel == "RUMI_SUBMAP_ACK" and message.status == message.COMPLETE:
            self._take_ack(time_s, message)

    def _take_ack(self, time_s, ack):
        key = (ack.sender, ack.transfer_id)
        if key in self._done:
            return
        self._done.add(key)
        self.updates += 1
        self.last_ack_s = time_s
        update = self.transfers.update(*key)
        if not update:
            self.unseen += 1
            self._unseen_revisions.append(ack.revision)
            return
        self._copies.setdefault(update.key, _Copy()).apply(update)

    def compare(self, database):
        db = sqlite3.connect(f"file:{database}?mode=ro", uri=True)
        rows = {(session, id): (row, revision, closed) for row, session, id, revision, closed in
                db.execute("SELECT submap, session, id, revision, closed FROM submaps")}
        result = {"submaps": len(self._copies), "lost_submaps": 0, "older": 0, "culled": 0,
                  **{kind: 0 for kind in KINDS}, **{f"lost_{kind}": 0 for kind in KINDS},
                  "unsent": self._unsent(rows), "open": sum(not closed for _, _, closed in rows.values())}
        for key, copy in self._copies.items():
            if key not in rows:
                result["lost_submaps"] += 1
            row, revision, _ = rows.get(key, (None, 0, 0))
            result["older"] += revision < copy.revision
            for kind, lost in self._missing(db, row, key, copy).items():
                result[kind] += len(copy.elements[kind])
                # Post-culling takes keyframes and landmarks out of back submaps; every frame keeps its pose.
                name = "culled" if copy.is_back and kind != "frames" and row else f"lost_{kind}"
                result[name] += len(lost)
        newest = max((revision for _, revision, _ in rows.values()), default=0)
        result["older"] += sum(revision > newest for revision in self._unseen_revisions)
        return result

    def _missing(self, db, row, key, copy):
        stored = {}
        for kind, column, table in (("keyframes", "id", "keyframes"), ("landmarks", "id", "landmarks"),
                                    ("frames", "utime", "frame_poses")):
            stored[kind] = {id for (id,) in db.execute(f"SELECT {column} FROM {table} WHERE submap = ?", (row,))}
        later = [u for u in self._sent[key] if u.revision > copy.revision]  # stored, perhaps, but not acknowledged
        missing = {}
        for kind in KINDS:
            taken_out = set()
            for update in later:
                if update.base_revision == 0:
                    taken_out |= copy.elements[kind] - update.told[kind]
                taken_out |= update.removed[kind]
            missing[kind] = copy.elements[kind] - stored[kind] - taken_out
        return missing

    def _unsent(self, rows):
        """Submaps whose latest update that was sent is not in the file."""
        return sum(max(u.revision for u in sent) > rows.get(key, (0, 0, 0))[1] for key, sent in self._sent.items())
