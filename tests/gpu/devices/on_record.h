#pragma once
// A renderer on a device that says it is another one (tests/layers/limits.cpp). One at a time, one thread.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <unistd.h>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

namespace shvr::test {

/// A device of the record; the test fails if the program requests anything that it lacks.
class On {
public:
    explicit On(const char* record)
        : log_(std::filesystem::temp_directory_path() / sentence("shvr-limits-", getpid(), "-", record))
    {
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_limits", 1);
        setenv("SHVR_LIMITS", record, 1);
        setenv("SHVR_LIMITS_LOG", log_.c_str(), 1);
        renderer_.emplace(Renderer::Options{.device = {.validation = true}, .threads = 1});
    }
    On(const On&) = delete;
    ~On()
    {
        for (const std::string& message : renderer_->device().take_validation_messages()) FAIL_CHECK(message);
        renderer_.reset();
        unsetenv("VK_INSTANCE_LAYERS");
        std::ifstream log(log_);
        for (std::string line; std::getline(log, line);) FAIL_CHECK(line);
        std::filesystem::remove(log_);
    }
    Renderer* operator->() { return &*renderer_; }
    Renderer& operator*() { return *renderer_; }

private:
    std::filesystem::path log_;
    std::optional<Renderer> renderer_;
};

}  // namespace shvr::test
