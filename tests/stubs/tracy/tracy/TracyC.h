#pragma once
// The part of Tracy's C interface that SHVR calls, written from its public header. Each call is written to standard
// output as a line.

#include <stddef.h>
#include <stdint.h>

extern "C" {

struct ___tracy_c_zone_context {
    uint32_t id;
    int32_t active;
};
typedef struct ___tracy_c_zone_context TracyCZoneCtx;

struct ___tracy_gpu_time_data {
    int64_t gpuTime;
    uint16_t queryId;
    uint8_t context;
};
struct ___tracy_gpu_zone_begin_data {
    uint64_t srcloc;
    uint16_t queryId;
    uint8_t context;
};
struct ___tracy_gpu_zone_end_data {
    uint16_t queryId;
    uint8_t context;
};
struct ___tracy_gpu_new_context_data {
    int64_t gpuTime;
    float period;
    uint8_t context;
    uint8_t flags;
    uint8_t type;
};
struct ___tracy_gpu_context_name_data {
    uint8_t context;
    const char* name;
    uint16_t len;
};

uint64_t ___tracy_alloc_srcloc_name(uint32_t line, const char* source, size_t sourceSz, const char* function,
                                    size_t functionSz, const char* name, size_t nameSz, uint32_t color);
TracyCZoneCtx ___tracy_emit_zone_begin_alloc(uint64_t srcloc, int32_t active);
void ___tracy_emit_zone_end(TracyCZoneCtx ctx);
void ___tracy_emit_gpu_zone_begin_alloc(const struct ___tracy_gpu_zone_begin_data data);
void ___tracy_emit_gpu_zone_end(const struct ___tracy_gpu_zone_end_data data);
void ___tracy_emit_gpu_time(const struct ___tracy_gpu_time_data data);
void ___tracy_emit_gpu_new_context(const struct ___tracy_gpu_new_context_data data);
void ___tracy_emit_gpu_context_name(const struct ___tracy_gpu_context_name_data data);
void ___tracy_emit_frame_mark(const char* name);
int32_t ___tracy_connected(void);
}
