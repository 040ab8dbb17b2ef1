// SPDX-License-Identifier: BSD-3-Clause
// Uses EGL_MESA_platform_surfaceless, EGL_KHR_surfaceless_context and EGL_KHR_no_config_context.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <stdexcept>
#include <string>

#include "viewer_offscreen/gl/gl_platform.h"

namespace rumi::viewer_offscreen {
namespace {

class Egl : public GlPlatform {
 public:
  Egl() {
    library_ = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library_) throw std::runtime_error("libEGL.so.1 is not installed");
    load("eglGetProcAddress", &get_proc_address_);
    load("eglMakeCurrent", &make_current_);
    load("eglDestroyContext", &destroy_);
    load("eglGetError", &get_error_);
    decltype(&eglGetPlatformDisplay) get_display = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bind_api = nullptr;
    decltype(&eglCreateContext) create = nullptr;
    load("eglGetPlatformDisplay", &get_display);
    load("eglInitialize", &initialize);
    load("eglBindAPI", &bind_api);
    load("eglCreateContext", &create);
    display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY || !initialize(display_, nullptr, nullptr)) fail("no surfaceless display");
    bind_api(EGL_OPENGL_API);
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context_ = create(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context_ == EGL_NO_CONTEXT) fail("no OpenGL 3.3 core context");
  }
  // The whole process shares the display, so it is not terminated.
  ~Egl() override {
    make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    destroy_(display_, context_);
  }
  const char* name() const override { return "egl"; }
  void make_current() override {
    if (!make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) fail("its context cannot be made current");
  }
  Function function(const char* name) const override { return get_proc_address_(name); }

 private:
  template <class T>
  void load(const char* name, T* function) {
    *function = reinterpret_cast<T>(dlsym(library_, name));
    if (!*function) throw std::runtime_error(std::string("libEGL has no ") + name);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("EGL: " + what + " (error " + std::to_string(get_error_()) + ")");
  }

  void* library_ = nullptr;
  decltype(&eglGetProcAddress) get_proc_address_ = nullptr;
  decltype(&eglMakeCurrent) make_current_ = nullptr;
  decltype(&eglDestroyContext) destroy_ = nullptr;
  decltype(&eglGetError) get_error_ = nullptr;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlPlatform> open_egl() { return std::make_unique<Egl>(); }

}  // namespace rumi::viewer_offscreen
