#include "tools/bench/yardstick.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace shvr::bench {

namespace {

constexpr int NUMBERS = 1 << 15;  // 128 KiB of data: fit into the nearest caches, like most data that kernels read
constexpr int ROUNDS_OF_WORK = 150;

/// Multiplies and adds numbers like a kernel. The numbers stay between 0 and 1.
float worked(int seed)
{
    std::vector<float> numbers(NUMBERS);
    for (int i = 0; i < NUMBERS; ++i) numbers[size_t(i)] = float((i * 7919 + seed) % 1000) / 1000.0f;
    for (int time = 0; time < ROUNDS_OF_WORK; ++time)
        for (float& number : numbers) number = 0.75f * number + 0.25f * (1.0f - number) * number;
    float sum = 0.0f;
    for (const float number : numbers) sum += number;
    return sum;
}

}  // namespace

double yardstick_ms(int threads)
{
    static std::atomic<float> sink;  // prevents compilers from removing the work
    const auto begun = std::chrono::steady_clock::now();
    std::vector<std::jthread> workers;
    for (int i = 1; i < threads; ++i) workers.emplace_back([i] { sink.store(worked(i)); });
    sink.store(worked(0));
    workers.clear();  // waits for them
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace shvr::bench
