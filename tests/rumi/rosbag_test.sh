#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# ROS 1 bags and a program that others wrote, Debian's rosbag: it reads what `rumi export` writes, and `rumi import` reads
# what it writes of that, with each compression.
#   rosbag_test.sh RUMI
set -eu
rumi=$1
python=/usr/bin/python3  # Debian's, for which rosbag is installed
if ! $python -c "import rosbag" 2>/dev/null; then
  echo "skipped: apt-get install python3-rosbag"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$rumi" synth -q -o walk --seconds 1
"$rumi" export walk -o walk.bag --encoding grey --poses walk/groundtruth.txt
"$rumi" export walk -o jpeg.bag --encoding jpeg

cat >again.py <<'PYTHON'
import sys
import rosbag

# Types are made of the definitions in the bag, whose checksums must be theirs.
with rosbag.Bag(sys.argv[1]) as bag:
    topics = bag.get_type_and_topic_info().topics
    for name, topic in sorted(topics.items()):
        print(name, topic.msg_type, topic.message_count)
    for compression in ("none", "bz2", "lz4"):
        with rosbag.Bag(sys.argv[2] + "_" + compression + ".bag", "w", compression=compression) as again:
            stamps = []
            for topic, message, time in bag.read_messages():
                if hasattr(message, "header") and topic != "/rumi/path":
                    assert message.header.stamp == time, topic
                stamps.append(time)
                again.write(topic, message, time)
            assert stamps == sorted(stamps)
PYTHON
$python again.py walk.bag again >topics.txt
cat >expected.txt <<'TOPICS'
/camera/camera_info sensor_msgs/CameraInfo 30
/camera/image_raw sensor_msgs/Image 30
/rumi/path nav_msgs/Path 1
/rumi/pose geometry_msgs/PoseStamped 30
/tf tf2_msgs/TFMessage 30
TOPICS
diff expected.txt topics.txt
$python again.py jpeg.bag jpeg_again >topics.txt
cat >expected.txt <<'TOPICS'
/camera/camera_info sensor_msgs/CameraInfo 30
/camera/image_raw/compressed sensor_msgs/CompressedImage 30
TOPICS
diff expected.txt topics.txt

# The same images, calibration and truth, whoever wrote the bag.
for bag in walk again_none again_bz2 again_lz4; do
  "$rumi" import "$bag.bag" -o "$bag"_folder
  sed -i '/^# .*\.bag/d' "$bag"_folder/groundtruth.txt
done
for bag in again_none again_bz2 again_lz4; do diff -r walk_folder "$bag"_folder; done
"$rumi" import jpeg.bag -o jpeg_folder
"$rumi" import jpeg_again_lz4.bag -o jpeg_again_folder
diff -r jpeg_folder jpeg_again_folder
