// SPDX-License-Identifier: BSD-3-Clause
// An image_t as it comes from the network or a log, which is decoded in every way.
#include "bus/wire/image_codec.h"
#include "bus/wire/working_image.h"
#include "fuzz/good_messages.h"
#include "fuzz/mutation.h"

namespace rumi::fuzz {
namespace {

void run(View input) {
  image_t image;
  if (!Bus::decode(input, &image)) return;
  // The image may be refused; the code must only not crash.
  (void)decode_grey(image);
  (void)decode_bgr(image);
  for (const int reduction : {2, 4, 8}) (void)decode_reduced_grey(image, reduction);
  (void)decode_working_image(image, good_camera(), working_camera(good_camera(), kWidth / 2));
}

std::vector<Bytes> seeds() {
  image_t yuyv = good_image(1), rgb = make_rgb_image(2, cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(1, 2, 3)));
  yuyv.pixelformat = image_t::PIXEL_FORMAT_YUYV;
  yuyv.width /= 2;
  return {encode_message(good_image(1)), encode_message(good_jpeg(1)), encode_message(yuyv), encode_message(rgb)};
}

const Registered registered({"image_message", run, seeds, mutate_message});

}  // namespace
}  // namespace rumi::fuzz
