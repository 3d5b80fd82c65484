; BROKEN     Twin of 20c_farther_out_is_clearer.smt2: the direction is turned inward.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const Z Real)        ; how far away somebody is
(declare-const c Real)        ; clearance to be kept
(declare-const s Real)        ; sine of the passing direction
(declare-const k Real)        ; its cosine
(declare-const s1 Real)       ; sine of the direction farther out
(declare-const k1 Real)       ; its cosine
; Assumptions
(assert (> Z c))
(assert (> c 0))
(assert (= (* Z s) c))
(assert (>= k 0))
(assert (= (+ (* s s) (* k k)) 1))
(assert (= (+ (* s1 s1) (* k1 k1)) 1))
(assert (>= k1 0))
(assert (<= (- (* s1 k) (* k1 s)) 0))                 ; BROKEN: <= for >=

; Conclusion, negated
(assert (not (>= (* Z s1) c)))
(check-sat)
