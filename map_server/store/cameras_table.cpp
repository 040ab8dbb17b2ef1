// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/cameras_table.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "map_server/store/checked_values.h"

namespace rumi::map_server {

int64_t camera_row(const Camera& c, Database& database) {
  Statement find(
      database,
      "SELECT camera FROM cameras WHERE model = ? AND width = ? AND height = ? AND fx = ? AND fy = ? AND cx = ? "
      "AND cy = ? AND k1 = ? AND k2 = ? AND p1 = ? AND p2 = ? AND k3 = ? AND k4 = ? AND fps = ?");
  const auto bind = [&c](Statement& s) -> Statement& {
    return s.bind(static_cast<int>(c.model), c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3,
                  c.k4, c.fps);
  };
  if (bind(find).step()) return find.integer(0);
  Statement insert(database, "INSERT INTO cameras VALUES (NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  bind(insert).run();
  return sqlite3_last_insert_rowid(database.handle());
}

Camera read_camera(int64_t row, Database& database) {
  Statement select(database, "SELECT * FROM cameras WHERE camera = ?");
  if (!select.bind(row).step()) throw std::runtime_error(fmt::format("camera {} is missing", row));
  Camera c;
  c.model = checked_enum("a lens", select.integer(1), Camera::Model::kPinhole, Camera::Model::kKannalaBrandt);
  c.width = static_cast<int>(select.integer(2));
  c.height = static_cast<int>(select.integer(3));
  int column = 4;
  for (double* field : {&c.fx, &c.fy, &c.cx, &c.cy, &c.k1, &c.k2, &c.p1, &c.p2, &c.k3, &c.k4, &c.fps})
    *field = select.real(column++);
  if (const std::string wrong = c.check(); !wrong.empty()) throw std::runtime_error("a camera's " + wrong);
  return c;
}

}  // namespace rumi::map_server
