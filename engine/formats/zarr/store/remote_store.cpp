#include "engine/formats/zarr/store/remote_store.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/store/prepared_objects.h"
#include "engine/formats/zarr/store/zarr_json.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using State = RemoteObject::State;

constexpr std::array<std::string_view, 4> METADATA_NAMES{"zarr.json", ".zattrs", ".zgroup", ".zarray"};
/// Whether an image is a project is asked at each opening, so it is asked together with the metadata of the root.
constexpr std::string_view PROJECT_KEY = "shvr/volume.json";
/// Metadata older than this is requested again, to notice that a volume was removed.
constexpr std::chrono::seconds METADATA_AGE{30};
constexpr int64_t PREPARED_BYTES = int64_t{128} << 20;
/// Parts of an object are merged into one request if the gap between them, and the request, are at most this large.
constexpr int64_t MERGED_GAP_BYTES = int64_t{32} << 10, MERGED_BYTES = int64_t{8} << 20;

bool is_metadata(std::string_view key)
{
    const std::string_view name = key.substr(key.rfind('/') + 1);
    return std::ranges::find(METADATA_NAMES, name) != METADATA_NAMES.end() || name.ends_with(".json");
}

/// A request for one object that covers one or more wanted parts.
struct Request {
    RemoteWant want{};
    std::vector<const ZarrWant*> parts{};
};

PreparedObjects::Place place_of(const ZarrWant& want)
{
    return {want.key, want.offset.value_or(PreparedObjects::WHOLE)};
}

/// Merges parts that lie close to each other. `wants` must be sorted by key and offset.
std::vector<Request> merged(std::span<const ZarrWant* const> wants)
{
    std::vector<Request> requests;
    for (const ZarrWant* const want : wants) {
        const bool is_part = want->offset.has_value();
        if (is_part && *want->offset >= 0 && !requests.empty() && requests.back().want.key == want->key &&
            requests.back().want.part && requests.back().want.part->first >= 0) {
            ByteRange& before = *requests.back().want.part;
            const int64_t end = std::max(before.first + before.bytes, *want->offset + want->bytes);
            if (*want->offset - (before.first + before.bytes) <= MERGED_GAP_BYTES &&
                end - before.first <= MERGED_BYTES) {
                before.bytes = end - before.first;
                requests.back().parts.push_back(want);
                continue;
            }
        }
        RemoteWant single{.key = want->key, .max_bytes = want->bytes};
        if (is_part) single.part = ByteRange{*want->offset, want->bytes};
        requests.push_back({.want = std::move(single), .parts = {want}});
    }
    return requests;
}

/// Cuts the wanted part out of the response to a merged request.
RemoteObject part_of(const RemoteObject& object, const Request& request, const ZarrWant& want)
{
    RemoteObject part = object;
    if (object.state != State::found || request.parts.size() == 1) return part;
    const auto from = object.bytes.begin() + (*want.offset - request.want.part->first);
    part.bytes.assign(from, from + want.bytes);
    return part;
}

class RemoteStore final : public ZarrStore {
public:
    explicit RemoteStore(RemoteFolder folder) : folder_(std::move(folder)), prepared_(PREPARED_BYTES) {}

    /// Reads the metadata of the root. Reports failures now, since the volume cannot be opened without that metadata.
    void begin() const
    {
        std::vector<std::string> keys(METADATA_NAMES.begin(), METADATA_NAMES.end());
        keys.emplace_back(PROJECT_KEY);
        fetch_metadata(keys);
        const std::scoped_lock lock(mutex_);
        std::string refusal;
        for (const std::string_view name : METADATA_NAMES) {
            const std::string key(name);
            const RemoteObject& object = metadata_.at(key).object;
            if (object.state == State::failed) fail(object.failure);
            if (object.state == State::found) return;
            if (object.state == State::forbidden && refusal.empty()) refusal = object.failure;
        }
        if (!refusal.empty()) fail(refusal);
    }

    bool is_remote() const override { return true; }
    std::string offline_warning() const
    {
        if (!is_offline_) return {};
        return sentence(folder_.address(),
                        ": no server answers; what was read of it before is taken from the cache on this machine");
    }
    fs::path path_of(const std::string& key) const override { return folder_.name_of(key); }

    std::optional<int64_t> size_of(const std::string& key) const override
    {
        if (is_metadata(key)) {
            const auto bytes = metadata(key);
            return bytes ? std::optional(int64_t(bytes->size())) : std::nullopt;
        }
        {
            const std::scoped_lock lock(mutex_);
            if (const auto found = sizes_.find(hash_of(key)); found != sizes_.end()) return found->second;
        }
        const auto object = get_one({.key = key, .part = ByteRange{0, 1}});
        return object ? std::optional(object->object_bytes) : std::nullopt;
    }

    std::optional<std::vector<std::byte>> read(const std::string& key, int64_t max_bytes) const override
    {
        if (!is_metadata(key)) {
            auto object = get_one({.key = key, .max_bytes = max_bytes});
            return object ? std::optional(std::move(object->bytes)) : std::nullopt;
        }
        auto bytes = metadata(key);
        if (bytes && int64_t(bytes->size()) > max_bytes)
            fail(folder_.name_of(key), ": holds ", bytes->size(), " bytes; expected at most ", max_bytes);
        return bytes;
    }

    void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const override
    {
        if (part.empty()) return;
        const auto object = get_one({.key = key, .part = ByteRange{offset, int64_t(part.size())}});
        if (!object) fail(folder_.name_of(key), ": is missing; expected ", part.size(), " bytes from byte ", offset);
        std::ranges::copy(object->bytes, part.begin());
    }

    std::optional<Edge> read_edge(const std::string& key, bool is_end, int64_t bytes) const override
    {
        auto object = get_one({.key = key, .part = ByteRange{is_end ? -bytes : 0, bytes}});
        if (!object) return std::nullopt;
        if (object->object_bytes < bytes)
            fail(folder_.name_of(key),
                 ": the server does not state the size of the object; expected it in Content-Range");
        return Edge{.bytes = std::move(object->bytes), .value_bytes = object->object_bytes};
    }

    void prepare(std::span<const ZarrWant> wants) const override
    {
        std::vector<std::string> keys;
        std::vector<const ZarrWant*> announced;
        for (const ZarrWant& want : wants) {
            if (is_metadata(want.key))
                keys.push_back(want.key);
            else if (prepared_.announce(place_of(want)))
                announced.push_back(&want);
        }
        if (!keys.empty()) fetch_metadata(keys);
        std::ranges::sort(announced, {}, [](const ZarrWant* want) { return place_of(*want); });
        const std::vector<Request> requests = merged(announced);
        std::vector<RemoteWant> asked;
        for (const Request& request : requests) asked.push_back(request.want);
        try {
            const std::vector<RemoteObject> objects = folder_.get(asked);
            for (size_t i = 0; i < objects.size(); ++i)
                for (const ZarrWant* const part : requests[i].parts)
                    prepared_.provide(place_of(*part), part_of(objects[i], requests[i], *part));
        } catch (...) {
            for (const ZarrWant* const want : announced) prepared_.withdraw(place_of(*want));
            throw;
        }
    }

    bool list(const std::string& prefix, const std::function<bool(std::string_view)>&) const override
    {
        fail(folder_.name_of(prefix), ": its chunks cannot be listed over a network");
    }

private:
    struct Metadata {
        RemoteObject object{};
        Clock::time_point time{};
    };

    static uint64_t hash_of(std::string_view text) { return XXH3_64bits(text.data(), text.size()); }

    /// Fails if an object has changed since it was first read. Objects without an ETag cannot be compared.
    void compare(const std::string& key, const RemoteObject& object) const
    {
        if (object.state != State::found && object.state != State::missing) return;
        if (object.is_offline) is_offline_ = true;
        const std::scoped_lock lock(mutex_);
        if (object.state == State::found && object.object_bytes >= 0) sizes_[hash_of(key)] = object.object_bytes;
        if (object.state == State::found && object.etag.empty()) return;
        const uint64_t now = object.state == State::missing ? 0 : hash_of(object.etag) | 1;
        const auto [before, is_new] = etags_.try_emplace(hash_of(key), now);
        if (is_new || before->second == now) return;
        fail(folder_.name_of(key), ": ",
             now == 0              ? "was removed since it was first read"
             : before->second == 0 ? "was added since it was found missing"
                                   : "was changed since it was first read: it has another ETag",
             "; expected a volume that stays as it was opened: open it again");
    }

    /// Returns an object; null if it is missing. Fails if it cannot be read.
    std::optional<RemoteObject> get_one(const RemoteWant& want) const
    {
        std::optional<RemoteObject> object =
            prepared_.take({want.key, want.part ? want.part->first : PreparedObjects::WHOLE});
        // Not the wanted part: another part that begins at the same byte was prepared.
        if (object && object->state == State::found && want.part && int64_t(object->bytes.size()) != want.part->bytes)
            object.reset();
        if (!object) object = std::move(folder_.get(std::span(&want, 1))[0]);
        compare(want.key, *object);
        if (object->state == State::missing) return std::nullopt;
        if (object->state != State::found) fail(object->failure);
        return object;
    }

    void fetch_metadata(std::span<const std::string> keys) const
    {
        std::vector<RemoteWant> wants;
        {
            const std::scoped_lock lock(mutex_);
            for (const std::string& key : keys) {
                const auto kept = metadata_.find(key);
                if (kept == metadata_.end() || kept->second.object.state == State::failed ||
                    Clock::now() - kept->second.time > METADATA_AGE)
                    wants.push_back({.key = key, .max_bytes = MAX_ZARR_ATTRIBUTE_BYTES});
            }
        }
        std::vector<RemoteObject> objects = folder_.get(wants);
        for (size_t i = 0; i < wants.size(); ++i) {
            compare(wants[i].key, objects[i]);
            const std::scoped_lock lock(mutex_);
            metadata_[wants[i].key] = {std::move(objects[i]), Clock::now()};
        }
    }

    /// Returns the metadata; null if it is missing. Fails if it cannot be read.
    std::optional<std::vector<std::byte>> metadata(const std::string& key) const
    {
        fetch_metadata(std::span(&key, 1));
        const std::scoped_lock lock(mutex_);
        const RemoteObject& object = metadata_.at(key).object;
        if (object.state == State::missing) return std::nullopt;
        if (object.state != State::found) fail(object.failure);
        return object.bytes;
    }

    RemoteFolder folder_;
    mutable PreparedObjects prepared_;
    mutable std::atomic<bool> is_offline_ = false;
    mutable std::mutex mutex_;
    mutable std::unordered_map<std::string, Metadata> metadata_;
    mutable std::unordered_map<uint64_t, uint64_t> etags_;  ///< hashes of ETags by hash of the key; 0: object missing
    mutable std::unordered_map<uint64_t, int64_t> sizes_;
};

}  // namespace

std::string offline_warning(const ZarrStore& store)
{
    const auto* const remote = dynamic_cast<const RemoteStore*>(&store);
    return remote ? remote->offline_warning() : std::string();
}

std::shared_ptr<const ZarrStore> open_remote_store(RemoteFolder folder)
{
    auto store = std::make_shared<RemoteStore>(std::move(folder));
    store->begin();
    return store;
}

std::shared_ptr<const ZarrStore> open_remote_store(const std::string& address)
{
    return open_remote_store(RemoteFolder(address));
}

}  // namespace shvr
