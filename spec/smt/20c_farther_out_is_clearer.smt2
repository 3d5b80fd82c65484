; THEOREM    20c: directions farther out than the passing one keep more clearance.
; ASSUMED    The z axis is laid through somebody at the distance Z > c; (s, k) is the direction that
;            passes them at the clearance c (20b), and (s1, k1) a unit vector that is turned outward
;            from it by less than half a turn, while the person is still ahead.
; CONCLUDED  The line along (s1, k1) is c away from the person at least. So the directions that keep
;            clear of everybody on one side are an interval, and a smaller c only widens it.
; SOURCE     own; spec/valley.md, valley.INV-3.
; TWIN       the direction is turned inward.
; SOLVERS    z3
(set-info :status unsat)
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
(assert (>= (- (* s1 k) (* k1 s)) 0))

; Conclusion, negated
(assert (not (>= (* Z s1) c)))
(check-sat)
