#include "engine/base/atomic_file.h"

#include "engine/base/atomic_writer.h"

namespace shvr {

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> content)
{
    AtomicWriter writer(path);
    writer.append(content);
    writer.commit();
}

}  // namespace shvr
