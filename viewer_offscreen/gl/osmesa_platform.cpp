// SPDX-License-Identifier: BSD-3-Clause
#include <GL/glcorearb.h>
#include <dlfcn.h>

#include <array>
#include <stdexcept>
#include <string>

#include "base/this_process/account_limits.h"
#include "viewer_offscreen/gl/gl_platform.h"

namespace rumi::viewer_offscreen {
namespace {

// The constants of GL/osmesa.h, which newer systems do not have.
constexpr int kFormat = 0x22, kDepthBits = 0x30, kProfile = 0x33, kCoreProfile = 0x34, kMajorVersion = 0x36,
              kMinorVersion = 0x37;
using Context = struct osmesa_context*;
using CreateContextAttribs = Context (*)(const int* attributes, Context shared);
using MakeCurrent = GLboolean (*)(Context, void* buffer, GLenum type, GLsizei width, GLsizei height);
using DestroyContext = void (*)(Context);
using GetProcAddress = GlPlatform::Function (*)(const char* name);

constexpr const char* kLibrary = "libOSMesa.so.8";

// Returns why the library cannot be loaded. It may exist but not fit into the memory, or lack another library. Only the
// loader knows, and its message is about the last library that it tried: so it tries again.
std::string why_not_loaded() {
  void* const again = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  const char* said = again ? nullptr : dlerror();
  const std::string text = said ? said : "no reason given", name = kLibrary;
  const auto says = [&text](const char* part) { return text.find(part) != std::string::npos; };
  if (says("map segment") || says("allocate memory"))
    return name + " cannot be loaded: " + no_memory_text("not enough memory to map it");
  return says(kLibrary) && says("No such file") ? name + " is not installed" : name + " cannot be loaded: " + text;
}

class Osmesa : public GlPlatform {
 public:
  Osmesa() {
    // The library is never unloaded, because its renderer leaves threads and thread-local data behind.
    for (const char* name : {kLibrary, "libOSMesa.so.6"})
      if (!library_) library_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!library_) throw std::runtime_error(why_not_loaded());
    load("OSMesaMakeCurrent", &make_current_);
    load("OSMesaDestroyContext", &destroy_);
    load("OSMesaGetProcAddress", &get_proc_address_);
    CreateContextAttribs create = nullptr;
    load("OSMesaCreateContextAttribs", &create);
    const int attributes[] = {kFormat,       GL_RGBA, kDepthBits,    0, kProfile, kCoreProfile,
                              kMajorVersion, 3,       kMinorVersion, 3, 0};
    context_ = create(attributes, nullptr);
    if (!context_) throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context");
  }
  ~Osmesa() override {
    if (context_) destroy_(context_);
  }
  const char* name() const override { return "osmesa"; }
  void make_current() override {
    if (!make_current_(context_, window_.data(), GL_UNSIGNED_BYTE, 16, 16))
      throw std::runtime_error("OSMesa cannot make its context current");
  }
  Function function(const char* name) const override { return get_proc_address_(name); }

 private:
  template <class T>
  void load(const char* name, T* function) {
    *function = reinterpret_cast<T>(dlsym(library_, name));
    if (!*function) throw std::runtime_error(std::string("libOSMesa has no ") + name);
  }

  void* library_ = nullptr;
  MakeCurrent make_current_ = nullptr;
  DestroyContext destroy_ = nullptr;
  GetProcAddress get_proc_address_ = nullptr;
  Context context_ = nullptr;
  std::array<unsigned char, 4 * 16 * 16> window_{};  // OSMesa needs a buffer; nothing is drawn into it
};

}  // namespace

std::unique_ptr<GlPlatform> open_osmesa() { return std::make_unique<Osmesa>(); }

}  // namespace rumi::viewer_offscreen
