#include "engine/gpu/pipeline_cache.h"

#include <algorithm>
#include <cstring>
#include <iomanip>
#include <sstream>

#include "engine/base/assets.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"

namespace shvr::gpu {

namespace {

constexpr std::string_view MAGIC = "SHVR pipelines 1\n";

/// Computes a checksum (FNV-1a), because drivers check only the data's header and trust the rest.
uint64_t sum_of(std::span<const std::byte> bytes)
{
    uint64_t sum = 0xcbf29ce484222325;
    for (const std::byte byte : bytes) sum = (sum ^ uint64_t(byte)) * 0x100000001b3;
    return sum;
}

void append(std::vector<std::byte>& bytes, std::span<const std::byte> more)
{
    bytes.insert(bytes.end(), more.begin(), more.end());
}

void append_part(std::vector<std::byte>& bytes, std::span<const std::byte> part)
{
    const uint64_t size = part.size();
    append(bytes, std::as_bytes(std::span(&size, 1)));
    append(bytes, part);
}

/// Splits a part, preceded by its size, off the start of `bytes`; null if `bytes` are too short.
std::optional<std::span<const std::byte>> take_part(std::span<const std::byte>& bytes)
{
    uint64_t size = 0;
    if (bytes.size() < sizeof size) return std::nullopt;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.subspan(sizeof size);
    if (bytes.size() < size) return std::nullopt;
    const std::span<const std::byte> part = bytes.first(size);
    bytes = bytes.subspan(size);
    return part;
}

std::span<const std::byte> bytes_of(const std::string_view& text)
{
    return std::as_bytes(std::span(text));
}

std::string text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Lists the variants, one per line: "raycast PAGED 1 DEPTH 3".
std::string text_of(const std::vector<KernelVariant>& variants)
{
    std::ostringstream text;
    for (const auto& [kernel, constants] : variants) {
        text << kernel;
        for (const auto& [name, value] : constants) text << ' ' << name << ' ' << value;
        text << '\n';
    }
    return text.str();
}

std::vector<KernelVariant> variants_of(const std::string& text)
{
    std::vector<KernelVariant> variants;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line) && variants.size() < PipelineCache::MAX_LIKELY;) {
        std::istringstream words(line);
        KernelVariant variant;
        words >> variant.first;
        std::pair<std::string, uint32_t> constant;
        while (words >> constant.first >> constant.second) variant.second.push_back(constant);
        variants.push_back(std::move(variant));
    }
    return variants;
}

}  // namespace

std::vector<std::byte> encode(const KeptPipelines& kept, const std::string& driver)
{
    std::vector<std::byte> bytes;
    append(bytes, bytes_of(MAGIC));
    append_part(bytes, bytes_of(driver));
    append_part(bytes, bytes_of(text_of(kept.likely)));
    append_part(bytes, kept.data);
    const uint64_t sum = sum_of(bytes);
    append(bytes, std::as_bytes(std::span(&sum, 1)));
    return bytes;
}

std::optional<KeptPipelines> decode(std::span<const std::byte> bytes, const std::string& driver)
{
    uint64_t sum = 0;
    if (bytes.size() < MAGIC.size() + sizeof sum || text_of(bytes.first(MAGIC.size())) != MAGIC) return std::nullopt;
    std::memcpy(&sum, bytes.last(sizeof sum).data(), sizeof sum);
    bytes = bytes.first(bytes.size() - sizeof sum);
    if (sum != sum_of(bytes)) return std::nullopt;
    bytes = bytes.subspan(MAGIC.size());
    const auto of = take_part(bytes), likely = take_part(bytes), data = take_part(bytes);
    if (!of || !likely || !data || !bytes.empty() || text_of(*of) != driver) return std::nullopt;
    return KeptPipelines{variants_of(text_of(*likely)), {data->begin(), data->end()}};
}

PipelineCache::PipelineCache(Device& device) : device_(device)
{
    VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 found{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
    vkGetPhysicalDeviceProperties2(device.physical(), &found);
    const VkPhysicalDeviceProperties& properties = found.properties;
    std::ostringstream identity;
    identity << driver.driverName << '\n'
             << driver.driverInfo << '\n'
             << properties.deviceName << '\n'
             << properties.driverVersion << '\n'
             << std::hex << std::setfill('0');
    for (const uint8_t byte : properties.pipelineCacheUUID) identity << std::setw(2) << int(byte);
    driver_ = identity.str();
    if (const std::filesystem::path folder = cache_folder(); !folder.empty()) {
        std::ostringstream name;
        name << std::hex << "pipelines-" << properties.vendorID << '-' << properties.deviceID;
        file_ = folder / name.str();
    }
    try {
        if (!file_.empty() && is_file(file_))
            kept_ = decode(read_file(file_, MAX_BYTES), driver_).value_or(KeptPipelines());
    } catch (const std::exception&) {  // unreadable, or too large: treated as missing
    }
    const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                         .initialDataSize = kept_.data.size(),
                                         .pInitialData = kept_.data.data()};
    if (vkCreatePipelineCache(device.handle(), &info, nullptr, &handle_) != VK_SUCCESS) handle_ = VK_NULL_HANDLE;
    kept_.data = {};  // the driver has its own copy
}

PipelineCache::~PipelineCache()
{
    vkDestroyPipelineCache(device_.handle(), handle_, nullptr);
}

/// Returns the driver's data; empty if there is only a header, as with drivers that store nothing.
std::vector<std::byte> PipelineCache::data_of_driver() const
{
    size_t size = 0;
    if (vkGetPipelineCacheData(device_.handle(), handle_, &size, nullptr) != VK_SUCCESS) return {};
    std::vector<std::byte> data(size);
    if (vkGetPipelineCacheData(device_.handle(), handle_, &size, data.data()) != VK_SUCCESS) return {};
    data.resize(size);
    return size > sizeof(VkPipelineCacheHeaderVersionOne) ? data : std::vector<std::byte>();
}

void PipelineCache::save(const std::set<KernelVariant>& used) noexcept
{
    try {
        std::set<KernelVariant> more = used;
        for (const KernelVariant& known : kept_.likely) more.erase(known);
        if (!handle_ || file_.empty() || (compiled_ == 0 && more.empty())) return;
        KeptPipelines kept{{more.begin(), more.end()}, data_of_driver()};
        if (kept.data.empty()) return;
        kept.likely.insert(kept.likely.end(), kept_.likely.begin(), kept_.likely.end());
        kept.likely.resize(std::min(kept.likely.size(), MAX_LIKELY));
        std::filesystem::create_directories(file_.parent_path());
        write_file_atomically(file_, encode(kept, driver_));
    } catch (const std::exception&) {  // the disk is full or the folder not writable: the next run compiles again
    }
}

}  // namespace shvr::gpu
