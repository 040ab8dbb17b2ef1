// SPDX-License-Identifier: BSD-3-Clause
// Which landmarks decide where the camera is. What several keyframes have seen has been where it is for a while. What
// moves by itself never gets that old as a landmark: it is made, does not fit, and is made anew. However many such
// landmarks there are, they must not outvote the others.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// Where enough established landmarks are matched and agree: sets *pose to the one by them alone, and takes the other
// landmarks that contradict it out of *matched and of the frame's matches. Else does nothing. `matched` is of the
// frame.
void begin_with_established(const Submap& submap, Frame* frame, SE3* pose, FrameObservations* matched);

}  // namespace rumi::front_tracker
