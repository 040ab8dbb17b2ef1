// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

class ScratchFolder : public ::testing::Test {
 protected:
  ScratchFolder() {
    if (const char* before = getenv("TMPDIR")) before_ = before;
  }
  ~ScratchFolder() override { before_.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before_.c_str(), 1); }
  static void set(const std::string& folder) { setenv("TMPDIR", folder.c_str(), 1); }

  TemporaryFolder folder_;
  std::string before_;
};

TEST_F(ScratchFolder, IsTmpdirWhereThatCanBeUsed) {
  set(folder_.path());
  EXPECT_EQ(scratch_folder(), folder_.path());
}

TEST_F(ScratchFolder, IsAnotherWhereTmpdirIsMissingOrAFile) {
  for (const std::string& wanted : {std::string("/nowhere/tmp"), folder_.write("file", "")}) {
    set(wanted);
    const std::string chosen = scratch_folder();
    EXPECT_NE(chosen, wanted);
    EXPECT_EQ(why_unusable(chosen), "") << chosen;
  }
}

TEST_F(ScratchFolder, IsAnotherWhereTmpdirIsFullOrReadOnly) {
  const std::string disk = folder_.path();
  const int result = testing::run_on_small_disk(disk, 1'000'000, [&] {
    set(disk);
    if (scratch_folder() == disk) return 1;
    if (mount("", disk.c_str(), "", MS_REMOUNT | MS_RDONLY, nullptr) != 0) return 2;
    return why_unusable(disk).find("Read-only") == std::string::npos ? 3 : 0;
  });
  if (result < 0) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(result, 0);
}

TEST_F(ScratchFolder, SaysWhatIsWrongWithAFolder) {
  EXPECT_EQ(why_unusable(folder_.path()), "");
  EXPECT_EQ(why_unusable("/nowhere"), "is not there");
  EXPECT_EQ(why_unusable(folder_.write("file", "")), "is no folder");
}

}  // namespace
}  // namespace rumi
