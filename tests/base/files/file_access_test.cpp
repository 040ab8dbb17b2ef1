// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/file_access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/ordinary_user.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class FileAccess : public ::testing::Test {
 protected:
  FileAccess() {
    fs::permissions(folder_.path(), fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
    fs::create_directory(folder_.path() / "in");
    std::ofstream(folder_.path() / "in" / "a.txt") << "text";
  }
  ~FileAccess() override { allow("in", fs::perms::owner_all); }
  void allow(const std::string& name, fs::perms perms) const { fs::permissions(folder_.path() / name, perms); }
  std::string why(const std::string& name) const {
    return testing::as_ordinary_user([&] { return why_unreadable(folder_.path() / name); });
  }
  testing::TemporaryFolder folder_;
};

TEST_F(FileAccess, WhatIsThereAndOpenToAllIsRead) {
  allow("in", fs::perms::all);
  EXPECT_EQ(why("in"), "");
  EXPECT_EQ(why("in/a.txt"), "");
}

TEST_F(FileAccess, NamesTheOwnerOfWhatIsSomebodyElses) {
  if (geteuid() != 0) GTEST_SKIP() << "the folder is one's own";
  EXPECT_EQ(note_on_owner(folder_.path()), "");
  const auto note = [&](const char* name) {
    return testing::as_ordinary_user([&] { return note_on_owner(folder_.path() / name); });
  };
  EXPECT_THAT(note("in"), AllOf(HasSubstr("/in belongs to root (uid 0), and this is "), HasSubstr("uid 65534")));
  EXPECT_THAT(note("missing.db"), HasSubstr("; " + folder_.path().string() + " belongs to root")) << "its folder";
}

TEST_F(FileAccess, WhatIsMissingIsCalledMissing) {
  EXPECT_EQ(why("nothing"), "no such file or folder");
  EXPECT_EQ(why("in/a.txt/b"), "no such file or folder");
}

TEST_F(FileAccess, AClosedFileSaysHowItIsOpened) {
  allow("in", fs::perms::all);
  allow("in/a.txt", fs::perms::none);
  EXPECT_THAT(why("in/a.txt"), AllOf(HasSubstr("no permission to read it"), HasSubstr("chmod a+r /")));
}

TEST_F(FileAccess, BehindAClosedFolderNothingIsCalledMissing) {
  allow("in", fs::perms::none);
  EXPECT_THAT(why("in"), HasSubstr("no permission to read it"));
  const std::string inner = (folder_.path() / "in").string();
  EXPECT_THAT(why("in/a.txt"), HasSubstr("no permission to enter the folder " + inner));
  EXPECT_THAT(why("in/nothing"), HasSubstr("no permission to enter the folder " + inner));
  EXPECT_EQ(testing::as_ordinary_user([&] { return may_be_there(folder_.path() / "in/a.txt") ? "yes" : "no"; }), "yes");
  EXPECT_FALSE(may_be_there(folder_.path() / "nothing"));
}

}  // namespace
}  // namespace rumi
