// A front from many sites over a graph, in single precision by a circular queue of buckets and in double precision by a binary
// heap: what `fronts.py` times homeo's fronts beside.
//
// usage: fronts GRAPH: little-endian, the number of nodes n, of links m and of sites k (uint32 each), n + 1 starts and m
// targets (uint32), m lengths (float64), k sites (uint32). Printed are the median seconds of five runs each.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <queue>
#include <vector>

struct Graph {
    std::vector<uint32_t> starts, targets, sites;
    std::vector<double> lengths;
};

template <class T> std::vector<T> take(std::ifstream &file, size_t count) {
    std::vector<T> values(count);
    file.read(reinterpret_cast<char *>(values.data()), count * sizeof(T));
    return values;
}

struct Front {
    std::vector<float> distance;
    std::vector<uint32_t> source;
};

// Nodes within one bucket come in any order and again if they turn out to be nearer.
static Front by_buckets(const Graph &graph, const std::vector<float> &lengths, float width, float longest) {
    const size_t n = graph.starts.size() - 1, count = static_cast<size_t>(longest / width) + 2;
    Front front{std::vector<float>(n, std::numeric_limits<float>::infinity()), std::vector<uint32_t>(n, UINT32_MAX)};
    std::vector<std::vector<std::pair<uint32_t, float>>> buckets(count);
    size_t waiting = 0;
    auto arrive = [&](uint32_t v, float d, uint32_t source) {
        if (d < front.distance[v]) {
            front.distance[v] = d;
            front.source[v] = source;
            buckets[static_cast<size_t>(d / width) % count].push_back({v, d});
            ++waiting;
        }
    };
    for (uint32_t k = 0; k < graph.sites.size(); ++k) arrive(graph.sites[k], 0.0f, k);
    for (size_t at = 0; waiting > 0; at = (at + 1) % count) {
        auto &bucket = buckets[at];
        while (!bucket.empty()) {
            const auto [v, d] = bucket.back();
            bucket.pop_back();
            --waiting;
            if (d > front.distance[v]) continue;
            for (uint32_t k = graph.starts[v]; k < graph.starts[v + 1]; ++k)
                arrive(graph.targets[k], d + lengths[k], front.source[v]);
        }
    }
    return front;
}

static std::vector<double> by_heap(const Graph &graph) {
    const size_t n = graph.starts.size() - 1;
    std::vector<double> distance(n, std::numeric_limits<double>::infinity());
    std::vector<uint32_t> source(n, UINT32_MAX);
    using Entry = std::pair<double, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    for (uint32_t k = 0; k < graph.sites.size(); ++k) {
        distance[graph.sites[k]] = 0.0;
        source[graph.sites[k]] = k;
        queue.push({0.0, graph.sites[k]});
    }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > distance[v]) continue;
        for (uint32_t k = graph.starts[v]; k < graph.starts[v + 1]; ++k) {
            const uint32_t w = graph.targets[k];
            if (d + graph.lengths[k] < distance[w]) {
                distance[w] = d + graph.lengths[k];
                source[w] = source[v];
                queue.push({distance[w], w});
            }
        }
    }
    return distance;
}

template <class F> double median_seconds(F run) {
    std::vector<double> seconds;
    for (int i = 0; i < 5; ++i) {
        const auto start = std::chrono::steady_clock::now();
        run();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[2];
}

int main(int argc, char **argv) {
    if (argc != 2) return 2;
    std::ifstream file(argv[1], std::ios::binary);
    const auto counts = take<uint32_t>(file, 3);
    Graph graph;
    graph.starts = take<uint32_t>(file, counts[0] + 1);
    graph.targets = take<uint32_t>(file, counts[1]);
    graph.lengths = take<double>(file, counts[1]);
    graph.sites = take<uint32_t>(file, counts[2]);
    if (!file || counts[1] == 0) return 2;
    const std::vector<float> lengths(graph.lengths.begin(), graph.lengths.end());
    double sum = 0.0;
    for (double length : graph.lengths) sum += length;
    const float mean = static_cast<float>(sum / graph.lengths.size());
    const float longest = *std::max_element(lengths.begin(), lengths.end());
    Front front;
    std::vector<double> exact;
    const double buckets = median_seconds([&] { front = by_buckets(graph, lengths, mean, longest); });
    const double heap = median_seconds([&] { exact = by_heap(graph); });
    double worst = 0.0;
    for (size_t v = 0; v < exact.size(); ++v) worst = std::max(worst, std::abs(exact[v] - front.distance[v]) / mean);
    std::printf("%.6f %.6f\n", buckets, heap);
    return worst < 1e-2 ? 0 : 1;
}
