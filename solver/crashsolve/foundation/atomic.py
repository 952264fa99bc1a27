"""Words of memory by which threads notify each other how far they are.

    store_release(words, k, n) after writing  ...  load_acquire(words, k) == n before reading

What one thread has written before it stores a word, the other sees after it has loaded that word.
Plain Python runs these, with one thread; `translation/threads.py` compiles them.
"""


def load_acquire(words, k):
    """A word that other threads write."""
    return words[k]


def store_release(words, k, number):
    """Writes: words."""
    words[k] = number


def add_release(words, k, number):
    """Add to a word that others add to as well. Writes: words."""
    words[k] += number


def replaced(words, k, old, new):
    """Whether a word was still `old`, and is now replaced by `new`. Writes: words."""
    if words[k] != old:
        return False
    words[k] = new
    return True


def offer_processor():
    """Let another waiting thread run on this core."""


def sleep(microseconds):
    """Leave this core to others for so long."""
