# SPDX-License-Identifier: BSD-3-Clause
# Whoever imports the package `rumi` that lcm-gen made has rumi.lcm, too.
file(APPEND ${FILE} "\nfrom . import lcm\n")
