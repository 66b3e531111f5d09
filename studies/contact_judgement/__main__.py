"""Contact judgement: which parameters decide that two bodies touch, and what each of them moves."""

from studies.contact_judgement import STUDY

if __name__ == "__main__":
    STUDY.run()
