#include "engine/base/machine/machine.h"

#include <sched.h>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using test::TemporaryFolder;

namespace {

void write(const std::filesystem::path& path, std::string_view text)
{
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
}

}  // namespace

TEST_CASE("each control group above the process limits it (version 2)")
{
    const TemporaryFolder folder;
    const std::filesystem::path groups = folder.path / "sys/fs/cgroup";
    write(folder.path / "proc/self/cgroup", "0::/slurm/job_7/step_0\n");
    CHECK_FALSE(group_limits(folder.path).processors);
    CHECK_FALSE(group_limits(folder.path).memory_bytes);
    write(groups / "slurm/job_7/step_0/cpu.max", "max 100000\n");
    write(groups / "slurm/job_7/step_0/memory.max", "max\n");
    CHECK_FALSE(group_limits(folder.path).processors);
    write(groups / "slurm/job_7/cpu.max", "250000 100000\n");
    write(groups / "slurm/job_7/memory.max", "4294967296\n");
    write(groups / "slurm/memory.max", "8589934592\n");
    CHECK(group_limits(folder.path).processors == 2.5);
    CHECK(group_limits(folder.path).memory_bytes == 4294967296);
    write(groups / "cpu.max", "100000 100000\n");  // of a container, whose root is the mount
    CHECK(group_limits(folder.path).processors == 1.0);
}

TEST_CASE("control groups of version 1 limit processors and memory apart")
{
    const TemporaryFolder folder;
    const std::filesystem::path groups = folder.path / "sys/fs/cgroup";
    write(folder.path / "proc/self/cgroup", "9:memory:/job\n4:cpu,cpuacct:/job\n1:cpuset:/job\n");
    write(groups / "cpu/job/cpu.cfs_quota_us", "-1\n");
    write(groups / "cpu/job/cpu.cfs_period_us", "100000\n");
    write(groups / "memory/job/memory.limit_in_bytes", "1073741824\n");
    CHECK_FALSE(group_limits(folder.path).processors);
    CHECK(group_limits(folder.path).memory_bytes == 1073741824);
    write(groups / "memory/job/memory.limit_in_bytes", "9223372036854771712\n");
    CHECK_FALSE(group_limits(folder.path).memory_bytes);
    write(groups / "cpu/job/cpu.cfs_quota_us", "300000\n");
    CHECK(group_limits(folder.path).processors == 3.0);
}

TEST_CASE("files that say nothing limit nothing")
{
    const TemporaryFolder folder;
    CHECK_FALSE(group_limits(folder.path).processors);
    for (const char* text : {"", ":", "0:", "::", "0::", "x\n\n"}) {
        write(folder.path / "proc/self/cgroup", text);
        CHECK_FALSE(group_limits(folder.path).memory_bytes);
    }
}

TEST_CASE("affinity limits the processors")
{
    cpu_set_t before, one;
    REQUIRE(::sched_getaffinity(0, sizeof before, &before) == 0);
    CHECK(processors_allowed() <= CPU_COUNT(&before));
    int first = 0;
    while (!CPU_ISSET(first, &before)) ++first;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    REQUIRE(::sched_setaffinity(0, sizeof one, &one) == 0);
    CHECK(processors_allowed() == 1);
    CHECK(::sched_setaffinity(0, sizeof before, &before) == 0);
    CHECK(memory_allowed() > 0);
}
