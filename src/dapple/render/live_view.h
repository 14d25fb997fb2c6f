// Shows a running render in the image viewer tev (or any program that speaks its protocol) over TCP.
//
// After a pass, at most once per second, a copy of the beauty goes to a thread of its own, which connects, creates the
// image and sends it in bands of rows. The render never waits: while the thread is busy, newer images are not even
// made. A viewer that is not there, or goes away, is a warning; it is looked for again every ten seconds.
#pragma once

#include "dapple/image/image.h"
#include "dapple/render/render_job.h"

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace dapple {

// Messages of tev's protocol. Each begins with its length in bytes, that word included, and its kind.
namespace tev {

using Message = std::string;  // of bytes

// Asks for a new image of that name and size, shown at once.
Message create_image(const std::string& name, int width, int height, const std::vector<std::string>& channels);
// New pixels for the rows [first_row, first_row + rows) of an image, interleaved channels in the order given.
Message update_rows(const std::string& name, const std::vector<std::string>& channels, const Image& image,
                    int first_row, int rows);

}  // namespace tev

class LiveView final : public PassObserver {
public:
    // `server`: "host:port", "host" or ":port"; 127.0.0.1 and 14158 unless given. Throws UserError for another form or
    // an unknown host.
    LiveView(const std::string& server, std::string image_name);
    ~LiveView() override;

    void after_pass(const Film& film, const RenderCounters& counters) override;

    // The last image, whatever the time; waits until it is sent, for at most two seconds.
    void finish(const Film& film);

private:
    struct Address {
        int family = 0;
        std::vector<char> bytes;  // a sockaddr
    };
    void hand_over(Image image);
    void run(const std::stop_token& token);
    bool send_image(const Image& image, const std::stop_token& token);
    bool connect(const std::stop_token& token);
    bool send(const tev::Message& message, const std::stop_token& token);
    void disconnect(const std::string& why);

    std::string server_, name_;
    std::vector<Address> addresses_;
    int socket_ = -1;
    bool created_ = false, warned_ = false;
    double next_try_ = 0;

    std::mutex mutex_;  // guards waiting_, busy_
    std::condition_variable_any changed_;
    std::optional<Image> waiting_;
    bool busy_ = false;
    double last_handed_ = -10;
    std::jthread thread_;  // last: it uses the rest
};

}  // namespace dapple
