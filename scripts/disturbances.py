# SPDX-License-Identifier: BSD-3-Clause
"""The names of what disturbed_recordings.py can put into a recording. Run, it prints them."""

KINDS = (
    ["bonnet10", "bonnet20", "bonnet30", "caption", "rim", "dust", "arm"]
    + [f"{kind}{share}" for kind in ("follow", "overtake", "cross") for share in (20, 40, 60)]
    + ["people", "frozen", "doubled"]
)

if __name__ == "__main__":
    print("\n".join(KINDS))
