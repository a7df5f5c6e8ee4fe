// Makes one header valid in GLSL and in C++. Shared headers contain constants, parameter structs (in scalar block
// layout, so that a vec3 takes 12 bytes in both languages) and pure functions.
#ifndef SHVR_SHARED_H
#define SHVR_SHARED_H

#ifdef __cplusplus
#include <cstdint>

#include <glm/glm.hpp>
#define SHARED_BEGIN                                                                                                   \
    namespace shvr::gpu {                                                                                              \
    using namespace glm;                                                                                               \
    using uint = uint32_t;
#define SHARED_END }
#define SHARED_FUNCTION inline
#define SHARED_CONST inline constexpr
#else
#define SHARED_BEGIN
#define SHARED_END
#define SHARED_FUNCTION
#define SHARED_CONST const
#endif

#endif
