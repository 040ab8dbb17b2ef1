# SPDX-License-Identifier: BSD-3-Clause
"""acknowledged_test.py BUILD_DIR SOURCE_DIR: what is found to be lost of what was acknowledged."""
import pathlib
import sqlite3
import sys
import tempfile
import unittest
import zlib

BUILD, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "scripts"))
import bus_log  # noqa: E402
from acknowledged import Acknowledged  # noqa: E402

bus_log.use_types(BUILD)


def element(name, **members):
    message = bus_log.message_type(name)()
    for key, value in members.items():
        setattr(message, key, value)
    return message


def update(revision, landmarks=(), removed=(), frames=(), keyframes=(), base=None, submap_id=1):
    u = element("submap_update_t", session=7, submap_id=submap_id, revision=revision, kind=0 if submap_id > 0 else 1,
                base_revision=revision - 1 if base is None else base)
    u.landmarks = [element("landmark_t", id=i, descriptor=bytes(32)) for i in landmarks]
    u.removed_landmarks = list(removed)
    u.frames = [element("frame_t", utime=t, cam_from_keyframe=element("rigid_t")) for t in frames]
    u.keyframes = [element("keyframe_t", id=i, cam_from_submap=element("rigid_t")) for i in keyframes]
    u.nlandmarks, u.nremoved_landmarks = len(u.landmarks), len(u.removed_landmarks)
    u.nframes, u.nkeyframes = len(u.frames), len(u.keyframes)
    return u


class AcknowledgedTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = pathlib.Path(self.folder.name) / "map.db"
        self.db = sqlite3.connect(self.file)
        self.db.executescript("""CREATE TABLE submaps (submap INTEGER PRIMARY KEY, session, id, revision, closed);
            CREATE TABLE keyframes (submap, id); CREATE TABLE landmarks (submap, id);
            CREATE TABLE frame_poses (submap, utime);""")
        self.acknowledged = Acknowledged()
        self.transfers = 0

    def tearDown(self):
        self.db.close()
        self.folder.cleanup()

    def send(self, message, is_acknowledged=True, pieces=3):
        payload = message.encode()
        self.transfers += 1
        size = -(-len(payload) // pieces)
        for i in reversed(range(pieces)):
            data = payload[i * size:(i + 1) * size]
            chunk = element("chunk_t", sender="front", transfer_id=self.transfers, index=i, count=pieces, size=len(data),
                            total_size=len(payload), checksum=zlib.crc32(payload), data=data)
            for _ in range(2):
                self.acknowledged.take(0, "RUMI_SUBMAP", chunk)
        if is_acknowledged:
            ack = element("chunk_ack_t", sender="front", transfer_id=self.transfers, status=1, revision=message.revision)
            for _ in range(2):
                self.acknowledged.take(1, "RUMI_SUBMAP_ACK", ack)

    def store(self, revision, landmarks=(), frames=(), keyframes=(), id=1):
        self.db.execute("INSERT INTO submaps VALUES (NULL, 7, ?, ?, 1)", (id, revision))
        row, = self.db.execute("SELECT max(submap) FROM submaps").fetchone()
        for table, ids in (("landmarks", landmarks), ("frame_poses", frames), ("keyframes", keyframes)):
            self.db.executemany(f"INSERT INTO {table} VALUES (?, ?)", [(row, i) for i in ids])
        self.db.commit()
        return self.acknowledged.compare(self.file)

    def test_all_is_there(self):
        self.send(update(1, landmarks=[1, 2], frames=[10]))
        self.send(update(2, landmarks=[3], removed=[1], frames=[20]))
        result = self.store(2, landmarks=[2, 3], frames=[10, 20])
        self.assertEqual((result["landmarks"], result["frames"], self.acknowledged.updates), (2, 2, 2))
        for name in ("lost_submaps", "lost_landmarks", "lost_frames", "older", "unsent"):
            self.assertEqual(result[name], 0, name)

    def test_a_lost_element_and_an_older_revision_are_found(self):
        self.send(update(1, landmarks=[1, 2], frames=[10], keyframes=[0]))
        self.send(update(2, landmarks=[3], frames=[20]))
        result = self.store(1, landmarks=[1, 2], frames=[10])
        self.assertEqual((result["lost_landmarks"], result["lost_frames"], result["lost_keyframes"]), (1, 1, 1))
        self.assertEqual((result["older"], result["unsent"]), (1, 1))

    def test_a_lost_submap_is_found(self):
        self.send(update(1, landmarks=[1]))
        result = self.store(1, landmarks=[1], id=2)
        self.assertEqual((result["lost_submaps"], result["lost_landmarks"]), (1, 1))

    def test_what_was_not_acknowledged_is_not_missed(self):
        self.send(update(1, landmarks=[1]))
        self.send(update(2, landmarks=[2]), is_acknowledged=False)
        result = self.store(1, landmarks=[1])
        self.assertEqual((result["lost_landmarks"], result["unsent"]), (0, 1))

    def test_what_a_later_update_took_out_is_not_missed(self):
        self.send(update(1, landmarks=[1, 2, 3]))
        self.send(update(2, removed=[1]), is_acknowledged=False)
        self.send(update(3, landmarks=[3], base=0), is_acknowledged=False)
        self.assertEqual(self.store(3, landmarks=[3])["lost_landmarks"], 0)

    def test_a_back_submap_may_be_culled_but_keeps_its_frames(self):
        self.send(update(1, landmarks=[1], keyframes=[0, 1], frames=[10, 20], submap_id=-1))
        result = self.store(2, keyframes=[0], frames=[10], id=-1)
        self.assertEqual((result["culled"], result["lost_keyframes"], result["lost_frames"]), (2, 0, 1))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
