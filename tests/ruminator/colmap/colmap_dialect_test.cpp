// SPDX-License-Identifier: BSD-3-Clause
// The arguments for each version of COLMAP, and the message about an unusable one.
#include "ruminator/colmap/colmap_dialect.h"

#include <gmock/gmock.h>

#include <memory>
#include <regex>
#include <set>
#include <sstream>

#include "tests/ruminator/colmap/fake_colmap.h"
#include "tests/ruminator/colmap/mapper_command.h"

namespace rumi::ruminator {
namespace {

using ::testing::AllOf;
using testing::ColmapHelp;
using testing::command_for;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kNever;
using ::testing::Not;
using testing::TemporaryFolder;

// The arguments that all versions get.
constexpr const char* kMiddle =
    " --Mapper.num_threads 1 --Mapper.extract_colors 0 --Mapper.min_num_matches 15 --Mapper.multiple_models 1"
    " --Mapper.max_num_models 3 --Mapper.min_model_size 10 --Mapper.init_min_tri_angle 4"
    " --Mapper.init_min_num_inliers 100 --Mapper.abs_pose_min_num_inliers 15 --Mapper.filter_max_reproj_error 4"
    " --Mapper.ba_refine_focal_length 0 --Mapper.ba_refine_principal_point 0 --Mapper.ba_refine_extra_params 0"
    " --Mapper.ba_local_num_images 5 --Mapper.ba_local_max_num_iterations 10 --Mapper.ba_local_max_refinements 1"
    " --Mapper.ba_local_function_tolerance 0.0001 --Mapper.ba_global_max_num_iterations 15"
    " --Mapper.ba_global_max_refinements 1";
constexpr const char* kEnd = " --Mapper.ba_global_points_ratio 1.4 --Mapper.ba_global_function_tolerance 0.0001";

class ColmapDialectTest : public ::testing::Test {
 protected:
  // Runs a fake of this version and returns its arguments.
  std::string said_to(const ColmapHelp& help) {
    ColmapMapper mapper(testing::write_fake_colmap(here, testing::help_text(help), "exit 0"));
    const MapperOutcome outcome = mapper.run(command, settings, kNever);
    EXPECT_EQ(outcome.kind, MapperOutcome::Kind::kNoModel)
        << outcome.models.error_text();  // it understood its arguments, but left no model
    EXPECT_EQ(mapper.version(), help.version);
    return testing::read_file(here / "arguments");
  }
  // Asks a fake with this help text, and returns its problem().
  std::string problem_of(const std::string& help) {
    program = std::make_unique<ColmapProgram>(testing::write_fake_colmap(here, help, "exit 0"));
    program->ask(0, kNever);
    return program->problem();
  }
  std::string paths() const {
    return "mapper --database_path " + command.database + " --image_path " + command.output_folder + " --output_path " +
           command.output_folder;
  }

  const TemporaryFolder here;
  MapperCommand command = command_for(here, "models");
  MapperSettings settings;
  std::unique_ptr<ColmapProgram> program;
};

std::string without(const std::string& text, const std::string& part) {
  return std::regex_replace(text, std::regex(part), "");
}

TEST_F(ColmapDialectTest, Debian12IsSpokenTo) {
  EXPECT_EQ(said_to(testing::kDebian12), paths() + " --log_to_stderr 1 --random_seed 0" + kMiddle +
                                             " --Mapper.ba_global_images_ratio 1.4" + kEnd + "\n");
}

TEST_F(ColmapDialectTest, Debian13IsSpokenTo) {
  EXPECT_EQ(said_to(testing::kDebian13), paths() + " --log_to_stderr 1 --random_seed 0" + kMiddle +
                                             " --Mapper.ba_global_images_ratio 1.4" + kEnd + "\n");
}

TEST_F(ColmapDialectTest, SidIsSpokenTo) {
  EXPECT_EQ(said_to(testing::kSid),
            paths() +
                " --log_target stderr --log_color 0 --default_random_seed 0 --Mapper.random_seed 0"
                " --Mapper.structure_less_registration_fallback 0" +
                kMiddle + " --Mapper.ba_global_frames_ratio 1.4" + kEnd + "\n");
}

TEST_F(ColmapDialectTest, AModelIsExtendedInTheWordsOfEach) {
  command.input_model = here / "seed";
  command.fix_existing_images = true;
  EXPECT_THAT(said_to(testing::kDebian12),
              HasSubstr(" --input_path " + command.input_model + " --Mapper.fix_existing_images 1\n"));
  std::filesystem::remove_all(command.output_folder);
  EXPECT_THAT(said_to(testing::kSid),
              HasSubstr(" --input_path " + command.input_model + " --Mapper.fix_existing_frames 1\n"));
}

TEST_F(ColmapDialectTest, SettingsArriveInTheWordsOfEach) {
  settings.random_seed = 7;
  settings.min_model_size = 12;
  EXPECT_THAT(said_to(testing::kDebian12), AllOf(HasSubstr(" --random_seed 7 "), HasSubstr("min_model_size 12 ")));
  std::filesystem::remove_all(command.output_folder);
  EXPECT_THAT(said_to(testing::kSid),
              AllOf(HasSubstr(" --default_random_seed 7 --Mapper.random_seed 7 "), HasSubstr("min_model_size 12 ")));
}

TEST_F(ColmapDialectTest, NothingIsMissingFromWhatIsKnown) {
  for (const ColmapHelp* help : testing::kHelps) {
    EXPECT_EQ(problem_of(testing::help_text(*help)), "") << help->version;
    EXPECT_THAT(missing_options(program->options()), IsEmpty()) << help->version;
    EXPECT_THAT(options_left_out(program->options()), IsEmpty()) << help->version;
  }
}

TEST_F(ColmapDialectTest, AnOptionThatCanBeDoneWithoutIsLeftOutAndNamed) {
  ColmapHelp help = testing::kSid;
  const std::string fewer = without(help.mapper_options, "extract_colors |ba_global_frames_ratio ");
  help.mapper_options = fewer.c_str();
  EXPECT_THAT(said_to(help), AllOf(Not(HasSubstr("extract_colors")), Not(HasSubstr("frames_ratio")),
                                   HasSubstr(" --Mapper.min_num_matches 15 ")));
  EXPECT_EQ(problem_of(testing::help_text(help)), "");
  EXPECT_THAT(options_left_out(program->options()),
              ::testing::ElementsAre("--Mapper.extract_colors",
                                     "--Mapper.ba_global_images_ratio or --Mapper.ba_global_frames_ratio"));
}

TEST_F(ColmapDialectTest, WithoutWhatIsNeededItIsRefused) {
  ColmapHelp help = testing::kSid;
  const std::string fewer = without(help.mapper_options, "ba_refine_focal_length ");
  help.mapper_options = fewer.c_str();
  EXPECT_THAT(problem_of(testing::help_text(help)),
              AllOf(HasSubstr("colmap: the mapper of this COLMAP (4.2.1) has no option "
                              "--Mapper.ba_refine_focal_length; COLMAP 3.8 to 4.2 has what is needed"),
                    HasSubstr("windows are rebuilt without it")));
  const std::string all = testing::help_text(testing::kDebian12);
  EXPECT_THAT(problem_of(without(all, "  --(input|output)_path arg.*")),
              HasSubstr("(3.8) has no option --output_path, nor --input_path; "));
}

TEST_F(ColmapDialectTest, AVersionThatNobodyKnowsIsUsedIfItKnowsTheWords) {
  EXPECT_EQ(problem_of("COLMAP 17.0 (Commit)\n" + testing::option_lines(testing::kSid)), "");
  EXPECT_EQ(program->version(), "17.0");
  EXPECT_EQ(problem_of(testing::option_lines(testing::kSid)), "");
  EXPECT_EQ(program->version(), "");
  EXPECT_THAT(problem_of("  --database_path arg\n"), HasSubstr("COLMAP (of unknown version) has no option"));
}

TEST_F(ColmapDialectTest, AnotherProgramOfItsNameIsRefused) {
  EXPECT_THAT(problem_of("colmap: colour maps for plots\n  --palette arg\n"),
              HasSubstr("colmap: does not know COLMAP's command mapper: --palette arg"));
  EXPECT_THAT(problem_of("The GUI of COLMAP 3.8 only\n"), HasSubstr("does not know COLMAP's command mapper"));
}

}  // namespace
}  // namespace rumi::ruminator
