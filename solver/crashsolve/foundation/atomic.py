"""Words of memory by which two threads tell each other how far they are.

    store_release(words, k, n) after writing  ...  load_acquire(words, k) == n before reading

What one thread has written before it stores a word, the other sees after it has loaded that word.
These are what plain Python runs, one thread alone; `translation/threads.py` has them compiled.
"""


def load_acquire(words, k):
    """A word that another thread writes."""
    return words[k]


def store_release(words, k, number):
    """Writes: words."""
    words[k] = number


def give_way():
    """Let another thread have this core, if any waits for it."""
