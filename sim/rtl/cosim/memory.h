// A memory of 16-byte words behind a port that reads and writes at the same time, with latency and random pauses.
//
// A word is read as it stands when it is asked for, and written some cycles after it was handed over: who reads what is still being
// written gets what was there before, as on a bus that promises no order between the two directions.
//
// A narrower memory behind the port moves a word in several beats. Of a word that is written only those are moved in which anything changes.
#pragma once
#include <cstdint>
#include <cstring>
#include <deque>

struct Memory {
    uint32_t* words;  // four for each word of the port
    uint64_t count;
    uint32_t latency, pauses;  // of 8 cycles
    uint64_t random;
    uint32_t bytes = 16;  // of a beat: 4, 8 or 16

    struct Read {
        uint64_t due;
        uint32_t word[4];
    };
    struct Write {
        uint64_t due;
        uint32_t address, strobe, word[4];
    };
    std::deque<Read> reads;
    std::deque<Write> writes;
    uint64_t now = 0, read = 0, written = 0, beyond = 0;
    uint64_t read_free = 0, write_free = 0;  // when all beats before have been moved

    bool pause() {
        random = random * 6364136223846793005u + 1442695040888963407u;
        return (random >> 40) % 8 < pauses;
    }

    // Nothing is asked for before the reset is over.
    void reset() {
        reads.clear();
        writes.clear();
        now = read = written = beyond = read_free = write_free = 0;
    }

    uint64_t beats(uint32_t strobe) const {
        const uint32_t beat = (1u << bytes / 4) - 1;
        uint64_t count = 0;
        for (; strobe != 0; strobe >>= bytes / 4) count += (strobe & beat) != 0;
        return count;
    }

    // What the circuit sees in this cycle.
    template <typename Model>
    void offer(Model& m) {
        while (!writes.empty() && writes.front().due <= now) {
            const Write& w = writes.front();
            for (int i = 0; i < 4; i++)
                if (w.strobe >> i & 1) words[4 * uint64_t(w.address) + i] = w.word[i];
            writes.pop_front();
        }
        m.read_ready = !pause() && now >= read_free;
        m.write_ready = !pause() && now >= write_free;
        m.settled = writes.empty();
        m.word_valid = !reads.empty() && reads.front().due <= now;
        if (m.word_valid) std::memcpy(&m.word, reads.front().word, 16);
    }

    // What the circuit asks for in this cycle.
    template <typename Model>
    void take(Model& m) {
        if (m.word_valid) reads.pop_front();
        if (m.read_valid && m.read_ready) {
            read_free = now + beats(0xf);
            Read r{read_free + latency, {}};
            if (m.read_address < count) std::memcpy(r.word, words + 4 * uint64_t(m.read_address), 16);
            else beyond++;
            reads.push_back(r);
            read++;
        }
        if (m.write_valid && m.write_ready) {
            write_free = now + beats(m.write_strobe);
            Write w{write_free + latency, m.write_address, uint32_t(m.write_strobe), {}};
            std::memcpy(w.word, &m.write_word, 16);
            if (m.write_address < count) writes.push_back(w);
            else beyond++;
            written++;
        }
        now++;
    }
};

// A circuit with a memory, half a cycle at a time.
template <typename Model>
struct Clocked {
    Model& m;
    Memory& memory;

    void tick() {
        memory.offer(m);
        m.clk = 0;
        m.eval();
    }

    void edge() {
        memory.take(m);
        m.clk = 1;
        m.eval();
    }
};
