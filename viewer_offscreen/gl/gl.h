// SPDX-License-Identifier: BSD-3-Clause
// The functions of OpenGL 3.3 core that are used here, as pointers from the platform that provides the context. No
// OpenGL library is linked, so that a program runs with whichever library the machine has. They may be called after
// OffscreenContext::make_current().
#pragma once

#include <GL/glcorearb.h>

namespace rumi::viewer_offscreen {

#define RUMI_GL_FUNCTIONS(F)                                                   \
  F(PFNGLACTIVETEXTUREPROC, glActiveTexture)                                   \
  F(PFNGLATTACHSHADERPROC, glAttachShader)                                     \
  F(PFNGLBINDBUFFERPROC, glBindBuffer)                                         \
  F(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)                               \
  F(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer)                             \
  F(PFNGLBINDTEXTUREPROC, glBindTexture)                                       \
  F(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray)                               \
  F(PFNGLBLENDFUNCPROC, glBlendFunc)                                           \
  F(PFNGLBLITFRAMEBUFFERPROC, glBlitFramebuffer)                               \
  F(PFNGLBUFFERDATAPROC, glBufferData)                                         \
  F(PFNGLCHECKFRAMEBUFFERSTATUSPROC, glCheckFramebufferStatus)                 \
  F(PFNGLCLEARPROC, glClear)                                                   \
  F(PFNGLCLEARCOLORPROC, glClearColor)                                         \
  F(PFNGLCOMPILESHADERPROC, glCompileShader)                                   \
  F(PFNGLCREATEPROGRAMPROC, glCreateProgram)                                   \
  F(PFNGLCREATESHADERPROC, glCreateShader)                                     \
  F(PFNGLDELETESHADERPROC, glDeleteShader)                                     \
  F(PFNGLDISABLEPROC, glDisable)                                               \
  F(PFNGLDRAWARRAYSPROC, glDrawArrays)                                         \
  F(PFNGLENABLEPROC, glEnable)                                                 \
  F(PFNGLENABLEVERTEXATTRIBARRAYPROC, glEnableVertexAttribArray)               \
  F(PFNGLFRAMEBUFFERRENDERBUFFERPROC, glFramebufferRenderbuffer)               \
  F(PFNGLFRONTFACEPROC, glFrontFace)                                           \
  F(PFNGLGENBUFFERSPROC, glGenBuffers)                                         \
  F(PFNGLGENERATEMIPMAPPROC, glGenerateMipmap)                                 \
  F(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)                               \
  F(PFNGLGENRENDERBUFFERSPROC, glGenRenderbuffers)                             \
  F(PFNGLGENTEXTURESPROC, glGenTextures)                                       \
  F(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays)                               \
  F(PFNGLGETPROGRAMINFOLOGPROC, glGetProgramInfoLog)                           \
  F(PFNGLGETPROGRAMIVPROC, glGetProgramiv)                                     \
  F(PFNGLGETSHADERINFOLOGPROC, glGetShaderInfoLog)                             \
  F(PFNGLGETSHADERIVPROC, glGetShaderiv)                                       \
  F(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)                         \
  F(PFNGLLINKPROGRAMPROC, glLinkProgram)                                       \
  F(PFNGLMULTIDRAWELEMENTSPROC, glMultiDrawElements)                           \
  F(PFNGLPIXELSTOREIPROC, glPixelStorei)                                       \
  F(PFNGLPOINTSIZEPROC, glPointSize)                                           \
  F(PFNGLREADPIXELSPROC, glReadPixels)                                         \
  F(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, glRenderbufferStorageMultisample) \
  F(PFNGLSCISSORPROC, glScissor)                                               \
  F(PFNGLSHADERSOURCEPROC, glShaderSource)                                     \
  F(PFNGLTEXIMAGE3DPROC, glTexImage3D)                                         \
  F(PFNGLTEXPARAMETERIPROC, glTexParameteri)                                   \
  F(PFNGLTEXSUBIMAGE3DPROC, glTexSubImage3D)                                   \
  F(PFNGLUNIFORM1FPROC, glUniform1f)                                           \
  F(PFNGLUNIFORM1IPROC, glUniform1i)                                           \
  F(PFNGLUNIFORM4FPROC, glUniform4f)                                           \
  F(PFNGLUNIFORMMATRIX4FVPROC, glUniformMatrix4fv)                             \
  F(PFNGLUSEPROGRAMPROC, glUseProgram)                                         \
  F(PFNGLVERTEXATTRIBPOINTERPROC, glVertexAttribPointer)                       \
  F(PFNGLVIEWPORTPROC, glViewport)

#define RUMI_DECLARE(type, name) extern type name;
RUMI_GL_FUNCTIONS(RUMI_DECLARE)
#undef RUMI_DECLARE

}  // namespace rumi::viewer_offscreen
