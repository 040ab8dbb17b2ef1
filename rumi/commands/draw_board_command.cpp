// SPDX-License-Identifier: BSD-3-Clause
// rumi draw-board -o board.pdf: a calibration board to print.
#include <fmt/format.h>

#include <memory>

#include "base/command_line.h"
#include "rumi/calibration/board_page.h"
#include "rumi/commands/commands.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string file, board = Board().to_string(), paper = papers().front().name;
  double dpi = 300;
};

int draw(const Arguments& arguments) {
  Board board;
  std::string error = parse_board(arguments.board, &board);
  const bool wrong_arguments = !error.empty();
  for (const Paper& paper : papers())
    if (error.empty() && arguments.paper == paper.name)
      error = write_board_page(board, paper, arguments.dpi, arguments.file);
  if (error.empty()) {
    fmt::print("{}: board {} on {}; print it at 100 %, and measure a square: {} mm\n", arguments.file,
               board.to_string(), arguments.paper, board.square_mm);
    return 0;
  }
  fmt::print(stderr, "rumi draw-board: {}\n", error);
  return wrong_arguments ? 2 : 1;
}

}  // namespace

void add_draw_board_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("draw-board", "Make a calibration board to print, for `rumi calibrate`");
  command->add_option("-o,--output", arguments->file, "the file; its ending tells what: .pdf or .png")
      ->type_name("FILE")
      .required();
  command->add_option("--board", arguments->board, "what board; columns and rows count squares")
      ->type_name(kBoardSyntax)
      ->show_default();
  std::vector<std::string> names;
  for (const Paper& paper : papers()) names.emplace_back(paper.name);
  command->add_option("--paper", arguments->paper, "it is turned as fits")->one_of(names)->show_default();
  command->add_option("--dpi", arguments->dpi, "of a .png, pixels per inch")->in_range(72.0, 1200.0)->show_default();
  std::string dictionaries;
  for (const BoardDictionary& dictionary : board_dictionaries())
    dictionaries += (dictionaries.empty() ? "" : ", ") + std::string(dictionary.name);
  command->footer(fmt::format("Boards: charuco:9x7:26:19:4X4_50, chessboard:9x7:26. DICTIONARY is {}.", dictionaries));
  command->on_chosen([arguments, chosen] { *chosen = [arguments] { return draw(*arguments); }; });
}

}  // namespace rumi::tool
