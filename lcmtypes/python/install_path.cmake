# SPDX-License-Identifier: BSD-3-Clause
# Runs while the Python package is installed. Where the python3 on the PATH looks into a folder below the prefix, as Debian's
# does with /usr/local, it is told where the package is; else a person is. Given: package_dir, as it is below the prefix.
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_PREFIX NORMALIZE OUTPUT_VARIABLE prefix)
cmake_path(ABSOLUTE_PATH package_dir BASE_DIRECTORY ${prefix} NORMALIZE OUTPUT_VARIABLE package)
execute_process(COMMAND python3 -c "import site; print(*site.getsitepackages(), sep=chr(59), end='')"
                OUTPUT_VARIABLE folders ERROR_QUIET)
set(site "")
foreach(folder ${folders})
  cmake_path(IS_PREFIX prefix "${folder}" NORMALIZE is_below)
  string(LENGTH "${folder}" length)
  string(LENGTH "${site}" shortest)  # with /usr, dist-packages of python3 rather than those of /usr/local
  if(is_below AND (NOT site OR length LESS shortest))
    set(site "${folder}")
  endif()
endforeach()
if(site)
  message(STATUS "Installing: $ENV{DESTDIR}${site}/rumi.pth")
  file(WRITE "$ENV{DESTDIR}${site}/rumi.pth" "${package}\n")
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${site}/rumi.pth")
else()
  message(STATUS "For Python's `import rumi`: export PYTHONPATH=${package}")
endif()
