#pragma once
// Reads objects below an address by HTTP requests, with retries and redirects. Never lists or writes. Any thread may
// call these; a thread blocks until its own requests are done or its wait is ended (engine/base/waits/waits.h).
//
// Objects are cached on disk (object_cache.h). A cached object is revalidated by its ETag: if it is unchanged, the
// server sends no body. If no server answers, the cached object is used, and for half a minute all other cached objects
// are used without asking the server.

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/remote/object_cache.h"
#include "engine/remote/s3.h"
#include "engine/remote/transport.h"

namespace shvr {

struct RemoteWant {
    std::string key{};                ///< path relative to the address; empty: the address itself
    std::optional<ByteRange> part{};  ///< null: the whole object
    int64_t max_bytes = 0;            ///< maximum size of a whole object; ignored for a part, whose size is known
};

struct RemoteObject {
    enum class State {
        found,
        missing,    ///< 404
        forbidden,  ///< 401, 403: also for missing objects of a bucket, if the user may not list it
        failed
    };
    State state = State::failed;
    std::vector<std::byte> bytes{};
    std::string etag{};
    int64_t object_bytes = -1;  ///< size of the whole object; below 0: unknown
    std::string failure{};      ///< one sentence that names the object; empty if `found` or `missing`
    bool is_unreached = false;  ///< failed before a server answered
    bool is_offline = false;    ///< taken from the cache, since no server answered
};

/// Time between attempts: doubles after each one, and is shortened by a random part.
struct RetryPace {
    double first_s = 0.2, most_s = 8.0;
};

class RemoteFolder {
public:
    /// `address`: an address without a query. Fails if the text is no address, or its scheme is not supported.
    explicit RemoteFolder(std::string address);
    /// `cache`: may be null; must outlive this object.
    RemoteFolder(std::string address, std::shared_ptr<const Transport> transport, RetryPace pace,
                 const ObjectCache* cache = nullptr);

    /// Returns the address of an object for messages, without a query.
    std::string name_of(const std::string& key) const;
    const std::string& address() const { return address_; }
    /// Whether requests carry keys or a query. Other users must not be able to read the cached objects then.
    bool is_private() const { return keys_.has_value() || !query_.empty(); }

    /// Reads several objects in parallel; returns them in the order of `wants`. An unreadable object does not throw.
    std::vector<RemoteObject> get(std::span<const RemoteWant> wants) const;

private:
    struct Asking;
    std::string url_of_key(const std::string& key) const;
    void judge(Asking& asking, RemoteResponse&& response) const;
    void redirect(Asking& asking, const RemoteResponse& response) const;
    void take(Asking& asking, RemoteResponse&& response) const;
    std::string cached_name(const RemoteWant& want) const;
    void look_up(Asking& asking) const;
    void keep(const Asking& asking) const;
    bool is_offline() const;

    std::string address_, url_, query_;
    std::optional<SigningKeys> keys_;
    bool is_s3_ = false;
    std::shared_ptr<const Transport> transport_;
    RetryPace pace_;
    const ObjectCache* cache_;
    /// Time of the steady clock, in milliseconds, at which a server was last unreachable; -1: never. Shared by copies.
    std::shared_ptr<std::atomic<int64_t>> unreached_ms_ = std::make_shared<std::atomic<int64_t>>(-1);
};

}  // namespace shvr
