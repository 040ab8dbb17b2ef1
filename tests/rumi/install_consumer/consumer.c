/* SPDX-License-Identifier: BSD-3-Clause */
#include "lcmtypes/rumi_image_t.h"

int main(void) {
  /* The fingerprint of bot_core.image_t, which the first eight bytes of every encoded image carry. */
  rumi_image_t image = {0};
  uint8_t bytes[64];
  int size = rumi_image_t_encode(bytes, 0, sizeof bytes, &image);
  return size > 8 && bytes[0] == 0x14 && bytes[1] == 0x73 && bytes[7] == 0xf0 ? 0 : 1;
}
