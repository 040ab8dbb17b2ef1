// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/options.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace rumi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Example {
  int keypoints = 1000;
  double ratio = 0.7;
  bool enabled = true;
  std::string mode = "fast";
  std::string title = "plain: \"quoted\" # text";
};

class OptionsTest : public testing::Test {
 protected:
  OptionsTest() { describe(table_, o_); }
  static void describe(OptionTable& table, Example& o) {
    table.add("tracker.keypoints", &o.keypoints, "keypoints", "per frame", 50, 20000);
    table.add("tracker.ratio", &o.ratio, "", "best to second best", 0.1, 1.0);
    table.add("viewer.enabled", &o.enabled, "draw at all");
    table.add("viewer.mode", &o.mode, "how to draw", {"fast", "good"});
    table.add("viewer.title", &o.title, "above the picture");
  }
  std::string load(const std::string& text) { return table_.load_yaml_text(text, "x.yaml"); }
  Example o_;
  OptionTable table_;
};

TEST_F(OptionsTest, YamlSetsWhatItNamesAndLeavesTheRest) {
  EXPECT_EQ(load("tracker: {keypoints: 70, ratio: 0.25}\nviewer:\n  enabled: off\n  mode: good\n"), "");
  EXPECT_EQ(o_.keypoints, 70);
  EXPECT_EQ(o_.ratio, 0.25);
  EXPECT_FALSE(o_.enabled);
  EXPECT_EQ(o_.mode, "good");
  EXPECT_EQ(o_.title, Example().title);
}

TEST_F(OptionsTest, DottedKeysAreTheSameAsSections) {
  EXPECT_EQ(load("tracker.keypoints: 71\n"), "");
  EXPECT_EQ(o_.keypoints, 71);
}

TEST_F(OptionsTest, WhatAFlagGaveIsToldByItsName) {
  EXPECT_EQ(table_.set(by_flag("--keypoints", "tracker.keypoints", "70")), "");
  EXPECT_EQ(o_.keypoints, 70);
  EXPECT_EQ(table_.set(by_flag("--title", "viewer.title", "a b=c")), "");
  EXPECT_EQ(o_.title, "a b=c");
  EXPECT_EQ(table_.set(by_flag("--keypoints", "tracker.keypoints", "0")),
            "--keypoints: tracker.keypoints = \"0\": expected a whole number from 50 to 20000 keypoints");
}

TEST_F(OptionsTest, ResetGivesTheDefaultsBack) {
  EXPECT_EQ(load("tracker: {keypoints: 70, ratio: 0.25}\nviewer: {enabled: off, mode: good, title: x}\n"), "");
  table_.reset();
  const Example initial;
  EXPECT_EQ(o_.keypoints, initial.keypoints);
  EXPECT_EQ(o_.ratio, initial.ratio);
  EXPECT_EQ(o_.enabled, initial.enabled);
  EXPECT_EQ(o_.mode, initial.mode);
  EXPECT_EQ(o_.title, initial.title);
}

TEST_F(OptionsTest, NothingToSetIsNoError) {
  EXPECT_EQ(load(""), "");
  EXPECT_EQ(load("# only a comment\n"), "");
  EXPECT_EQ(load("tracker:\n"), "");
  EXPECT_EQ(load("map_server: {whatever: [1, 2]}\nup:\n"), "") << "of another process";
  EXPECT_EQ(load("---\n# nothing\n---\n"), "");
}

TEST_F(OptionsTest, ErrorsNameFileLineKeyValueAndRange) {
  const std::string error = load("tracker:\n  ratio: 0.5\n  keypoints: 10\n");
  EXPECT_THAT(error, HasSubstr("x.yaml:3: tracker.keypoints = \"10\""));
  EXPECT_THAT(error, HasSubstr("whole number from 50 to 20000 keypoints"));
}

TEST_F(OptionsTest, AFileWithAnErrorChangesNothing) {
  EXPECT_NE(load("tracker: {ratio: 0.5, keypoints: 10}\n"), "");
  EXPECT_NE(load("viewer: {mode: good}\ntracker: {rati: 0.5}\n"), "");
  EXPECT_EQ(o_.ratio, 0.7);
  EXPECT_EQ(o_.mode, "fast");
}

TEST_F(OptionsTest, UnknownKeySuggestsTheNearest) {
  EXPECT_THAT(load("tracker: {keypiont: 70}\n"), HasSubstr("did you mean tracker.keypoints?"));
  EXPECT_THAT(table_.set("traker.ratio=0.5"), HasSubstr("did you mean tracker.ratio?"));
}

TEST_F(OptionsTest, ASectionOfNobodyIsAnError) {
  EXPECT_THAT(load("tracker: {keypoints: 70}\ntrackr:\n  keypoints: 70\n"),
              AllOf(HasSubstr("x.yaml:3: trackr.keypoints"), HasSubstr("did you mean tracker?")));
  EXPECT_THAT(load("mapserver: {database: a.db}\n"), HasSubstr("did you mean map_server?")) << "of another process";
  EXPECT_THAT(load("mapserver:\n"), HasSubstr("did you mean map_server?"));
  EXPECT_THAT(load("keypoints: 70\n"), HasSubstr("did you mean tracker.keypoints?"));
  EXPECT_EQ(o_.keypoints, Example().keypoints);
}

TEST_F(OptionsTest, ACalibrationIsNoFileOfOptions) {
  for (const char* text : {"model: pinhole\nfx: 1\n", "fx: 525\nfy: 525\n", "camera_matrix: {data: [1]}\n",
                           "cam0:\n  intrinsics: [1]\n", "Camera.fx: 500\n"})
    EXPECT_THAT(load(text), HasSubstr("--camera FILE")) << text;
}

TEST_F(OptionsTest, ASecondDocumentIsAnError) {
  EXPECT_THAT(load("tracker:\n  keypoints: 70\n---\ntracker:\n  keypoints: 80\n"),
              AllOf(HasSubstr("x.yaml:4: a second document"), HasSubstr("remove it")));
  EXPECT_EQ(load("---\ntracker: {keypoints: 70}\n...\n"), "");
}

TEST_F(OptionsTest, AKeyOfAMegabyteIsNotComparedLetterByLetter) {
  const std::string error = table_.set("tracker.keypoint" + std::string(1 << 20, 's') + "=1");
  EXPECT_THAT(error, HasSubstr("unknown option"));
  EXPECT_LT(error.size(), 300u);
}

TEST_F(OptionsTest, AKeyWithoutItsSectionOrWithAnotherOneSuggestsItsOwn) {
  for (const char* key : {"keypoints", "keypoint", "viewer.keypoints", "viewer.tracker.keypoints"})
    EXPECT_THAT(table_.set(std::string(key) + "=500"), HasSubstr("did you mean tracker.keypoints?")) << key;
}

TEST_F(OptionsTest, AKeyLikeNoneSaysWhereAllAre) {
  EXPECT_EQ(table_.set("colour_of_hair=5"),
            "--set colour_of_hair: unknown option (`rumi config` and `rumi config --expert` list all)");
}

TEST_F(OptionsTest, RefusesWhatIsNotEntirelyANumber) {
  for (const char* text : {"12abc", "abc", "", "1e3", "70.5", " 70", "0x50", "99999999999999999999", "nan"})
    EXPECT_NE(table_.set(std::string("tracker.keypoints=") + text), "") << text;
  for (const char* text : {"0.5x", "", "nan", "-nan", "inf", "0.05", "1.01", "1e400", "0,5"})
    EXPECT_NE(table_.set(std::string("tracker.ratio=") + text), "") << text;
  EXPECT_EQ(o_.keypoints, 1000);
  EXPECT_EQ(o_.ratio, 0.7);
}

TEST_F(OptionsTest, BoundsBelongToTheRange) {
  EXPECT_EQ(table_.set("tracker.keypoints=50"), "");
  EXPECT_EQ(table_.set("tracker.keypoints=20000"), "");
  EXPECT_EQ(table_.set("tracker.ratio=1e-1"), "");
  EXPECT_EQ(o_.keypoints, 20000);
  EXPECT_EQ(o_.ratio, 0.1);
}

TEST_F(OptionsTest, SetNeedsAnEqualsSignAndKeepsLaterOnes) {
  EXPECT_THAT(table_.set("tracker.keypoints"), HasSubstr("expected KEY=VALUE"));
  EXPECT_EQ(table_.set("viewer.title=a=b"), "");
  EXPECT_EQ(o_.title, "a=b");
}

TEST_F(OptionsTest, ChoicesAndBooleansAreChecked) {
  EXPECT_THAT(table_.set("viewer.mode=slow"), HasSubstr("expected one of fast, good"));
  EXPECT_THAT(table_.set("viewer.enabled=maybe"), HasSubstr("expected true or false"));
}

TEST_F(OptionsTest, OddYamlIsAnErrorAndNoCrash) {
  for (const char* text : {"tracker: [1, 2]", "tracker: {keypoints: [70]}", "tracker: {keypoints: {a: 1}}", "- 1\n- 2",
                           "just text", "tracker: {keypoints: 70", "tracker: {? [a] : 1}", "tracker: {keypoints: }",
                           "tracker: {keypoints: 70, keypoints: 80}", "\"\\xZZ\"", "tracker: 5", "a: *nowhere"})
    EXPECT_NE(load(text), "") << text;
}

TEST_F(OptionsTest, AnchorsDoNotMakeAFileEndless) {
  EXPECT_THAT(load("viewer: &a\n  \"\": *a\n"), AllOf(HasSubstr("x.yaml: line"), HasSubstr("anchors")));
  std::string groups = "a0: &a0 {x: 1}\n";
  for (int level = 1; level < 20; ++level) {
    groups += fmt::format("a{}: &a{} {{", level, level);
    for (int i = 0; i < 10; ++i) groups += fmt::format("{}: *a{}, ", i, level - 1);
    groups += "}\n";
  }
  EXPECT_THAT(load(groups), HasSubstr("anchors"));
  EXPECT_EQ(load("up: &a {x: 1}\nimage: *a\ntracker: {keypoints: 70}\n"), "");
}

TEST_F(OptionsTest, UnreadableFilesAreNamed) {
  EXPECT_THAT(table_.load_yaml("/nowhere/x.yaml"), HasSubstr("/nowhere/x.yaml: cannot be read (No such file"));
  EXPECT_THAT(table_.load_yaml("/tmp"), HasSubstr("/tmp: cannot be read"));
}

TEST_F(OptionsTest, ToYamlIsReadBack) {
  EXPECT_EQ(table_.set("tracker.ratio=0.123456789012345678"), "");
  EXPECT_EQ(table_.set("viewer.enabled=false"), "");
  const std::string yaml = table_.to_yaml(OptionTable::Which::kAll);
  EXPECT_THAT(yaml, HasSubstr("# per frame, keypoints (50 .. 20000)"));
  Example copy;
  OptionTable other;
  describe(other, copy);
  EXPECT_EQ(other.load_yaml_text(yaml, "copy"), "");
  EXPECT_EQ(copy.ratio, o_.ratio);
  EXPECT_EQ(copy.title, o_.title);
  EXPECT_FALSE(copy.enabled);
}

TEST_F(OptionsTest, YamlKeepsEveryByteOfAName) {
  for (const std::string title : {"K\xfc"
                                  "che",
                                  "a \"b\" c:\\d\n\t#e", "\xe2\x80\xa8 \xc2\x85 \xff\x01"}) {
    EXPECT_EQ(table_.set("viewer.title=" + title), "");
    Example copy;
    OptionTable other;
    describe(other, copy);
    EXPECT_EQ(other.load_yaml_text(table_.to_yaml(OptionTable::Which::kAll), "copy"), "");
    EXPECT_EQ(copy.title, title);
  }
}

TEST_F(OptionsTest, HelpShowsDefaultsNotPresentValues) {
  EXPECT_EQ(table_.set("tracker.keypoints=77"), "");
  EXPECT_THAT(table_.help(OptionTable::Which::kAll), HasSubstr("tracker.keypoints = 1000"));
  EXPECT_THAT(table_.help(OptionTable::Which::kAll), HasSubstr("how to draw (fast | good)"));
}

TEST_F(OptionsTest, UsersSeeTheirsAndExpertsTheOthersByRooms) {
  OptionTable table;
  int wanted = 1, first = 2, second = 3;
  table.add("part.wanted", &wanted, "", "a user's", 0, 9);
  table.group("one room");
  table.add("part.first", &first, "", "an expert's", 0, 9);
  table.group("the next");
  table.add("part.second", &second, "", "another", 0, 9);
  table.for_users({"part.wanted"});
  EXPECT_EQ(table.help(OptionTable::Which::kUsers).find("part.first"), std::string::npos);
  EXPECT_THAT(table.help(OptionTable::Which::kUsers), HasSubstr("part.wanted = 1"));
  EXPECT_THAT(table.help(OptionTable::Which::kAll), AllOf(HasSubstr("part.wanted"), HasSubstr("part.second")));
  EXPECT_EQ(table.to_yaml(OptionTable::Which::kUsers).substr(0, 17), "part:\n  wanted: 1");
  const std::string experts = table.to_yaml(OptionTable::Which::kExperts);
  EXPECT_THAT(experts, AllOf(HasSubstr("  # one room\n  first: 2"), HasSubstr("  # the next\n  second: 3")));
  EXPECT_EQ(experts.find("wanted"), std::string::npos);
  EXPECT_EQ(table.load_yaml_text(experts + "  wanted: 5\n", "both"), "") << "a file may have any of them";
  EXPECT_EQ(wanted, 5);
  EXPECT_THROW(table.for_users({"part.nothing"}), std::logic_error);
}

TEST(OptionTable, WhatTwoComponentsAddIsOneOptionOfBoth) {
  OptionTable table;
  int one = 3, other = 3;
  table.add("shared.value", &one, "px", "of both", 1, 9);
  table.add("shared.value", &other, "px", "of both", 1, 9);
  EXPECT_EQ(table.set("shared.value=5"), "");
  EXPECT_EQ(std::pair(one, other), std::pair(5, 5));
  EXPECT_NE(table.set("shared.value=10"), "");
  table.reset();
  EXPECT_EQ(std::pair(one, other), std::pair(3, 3));
  const std::string yaml = table.to_yaml(OptionTable::Which::kAll);
  EXPECT_EQ(yaml.find("value"), yaml.rfind("value")) << yaml;
  int third = 4;
  EXPECT_THROW(table.add("shared.value", &third, "px", "of both", 1, 9), std::logic_error) << "another default";
  third = 3;
  EXPECT_THROW(table.add("shared.value", &third, "px", "of both", 1, 8), std::logic_error) << "another range";
}

TEST_F(OptionsTest, WrongDeclarationsAreFoundAtOnce) {
  int field = 5;
  EXPECT_THROW(table_.add("tracker.keypoints", &field, "", "twice", 0, 10), std::logic_error);
  EXPECT_THROW(table_.add("nosection", &field, "", "", 0, 10), std::logic_error);
  EXPECT_THROW(table_.add("tracker.bad_default", &field, "", "", 6, 10), std::logic_error);
}

}  // namespace
}  // namespace rumi
